// Samplers on posteriors with published reference draws: ../shared/data/posteriors (from stan-dev/posteriordb; 10 chains of 1000 nearly independent draws
// each). The models are written here from their published definitions, in unconstrained coordinates with the Jacobians of the transformations. Rule: at the 5,
// 25, 50, 75 and 95 % reference quantiles |z| < 4, z = (p^ - p) / sqrt(p (1 - p) (1 / ESS_indicator + 1e-4)), 1e-4 for the reference's own draws.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/convergence/diagnostics.hpp"
#include "uq/sampler/sampler.hpp"

using namespace calomel;

namespace {

/// Beside the source tree, or where CALOMEL_SHARED points.
std::filesystem::path folder() {
  const char* named = std::getenv("CALOMEL_SHARED");
  return (named ? std::filesystem::path(named) : std::filesystem::path(CALOMEL_SOURCE_DIR).parent_path() / "shared") / "data" / "posteriors";
}
Json reference(const std::string& name) { return std::filesystem::exists(folder() / name) ? read_json(folder() / name) : Json(); }

constexpr double never = -std::numeric_limits<double>::infinity();
double log_normal(double x, double mean, double sd) { return -0.5 * std::pow((x - mean) / sd, 2) - std::log(sd); }
double log_cauchy(double x, double scale) { return -std::log1p(std::pow(x / scale, 2)); }
std::vector<double> numbers(const Json& list) { return list.get<std::vector<double>>(); }

/// Coordinates and quantities by name; the density and the transformation are the models'.
class Model : public LogDensity {
 public:
  Model(std::vector<std::string> coordinates, std::vector<std::string> quantities) : coordinates_(std::move(coordinates)), quantities_(std::move(quantities)) {}
  [[nodiscard]] const std::vector<std::string>& coordinates() const override { return coordinates_; }
  [[nodiscard]] std::vector<Quantity> quantities() const override {
    std::vector<Quantity> all;
    for (const auto& name : quantities_) all.push_back({name, ""});
    return all;
  }

 private:
  std::vector<std::string> coordinates_, quantities_;
};

std::vector<std::string> indexed(const std::string& name, int n) {
  std::vector<std::string> names;
  for (int i = 1; i <= n; ++i) names.push_back(name + '[' + std::to_string(i) + ']');
  return names;
}
std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// y_j ~ N(theta_j, sigma_j), theta_j = mu + tau z_j, z_j ~ N(0, 1), mu ~ N(0, 5), tau ~ half-Cauchy(5); Rubin 1981, Gelman et al. 2013, section 5.5. x: mu, ln
/// tau, z.
class EightSchools : public Model {
 public:
  EightSchools(const Json& data, bool jacobian)
      : Model(joined({"mu", "ln tau"}, indexed("z", 8)), joined({"mu", "tau"}, indexed("theta", 8))),
        y_(numbers(data["y"])),
        sigma_(numbers(data["sigma"])),
        jacobian_(jacobian) {}
  [[nodiscard]] double log_density(std::span<const double> x) const override {
    const double tau = std::exp(x[1]);
    double sum = log_normal(x[0], 0, 5) + log_cauchy(tau, 5) + (jacobian_ ? x[1] : 0);
    for (std::size_t j = 0; j < 8; ++j) sum += log_normal(x[2 + j], 0, 1) + log_normal(y_[j], x[0] + tau * x[2 + j], sigma_[j]);
    return std::isfinite(sum) ? sum : never;
  }
  void constrain(std::span<const double> x, std::span<double> q) const override {
    q[0] = x[0], q[1] = std::exp(x[1]);
    for (std::size_t j = 0; j < 8; ++j) q[2 + j] = x[0] + q[1] * x[2 + j];
  }

 private:
  std::vector<double> y_, sigma_;
  bool jacobian_;
};

/// y ~ N(beta . (1, hs, iq, hs iq), sigma), flat beta, sigma ~ half-Cauchy(2.5); Gelman and Hill 2006, section 3.3. x: beta, ln sigma.
class KidScores : public Model {
 public:
  explicit KidScores(const Json& data)
      : Model(joined(indexed("beta", 4), {"ln sigma"}), joined(indexed("beta", 4), {"sigma"})),
        y_(numbers(data["kid_score"])),
        hs_(numbers(data["mom_hs"])),
        iq_(numbers(data["mom_iq"])) {}
  [[nodiscard]] double log_density(std::span<const double> x) const override {
    double squares = 0;
    for (std::size_t i = 0; i < y_.size(); ++i) {
      const double r = y_[i] - (x[0] + x[1] * hs_[i] + x[2] * iq_[i] + x[3] * hs_[i] * iq_[i]);
      squares += r * r;
    }
    const double sigma = std::exp(x[4]), sum = -0.5 * squares / (sigma * sigma) - double(y_.size()) * x[4] + log_cauchy(sigma, 2.5) + x[4];
    return std::isfinite(sum) ? sum : never;
  }
  void constrain(std::span<const double> x, std::span<double> q) const override {
    for (std::size_t k = 0; k < 4; ++k) q[k] = x[k];
    q[4] = std::exp(x[4]);
  }

 private:
  std::vector<double> y_, hs_, iq_;
};

/// y_t ~ N(alpha + sum_k beta_k y_(t-k), sigma), K = 5; alpha, beta ~ N(0, 10), sigma ~ half-Cauchy(2.5); Stan user's guide, autoregressive models. x: alpha,
/// beta, ln sigma.
class Autoregression : public Model {
 public:
  explicit Autoregression(const Json& data)
      : Model(joined({"alpha"}, joined(indexed("beta", 5), {"ln sigma"})), joined({"alpha"}, joined(indexed("beta", 5), {"sigma"}))), y_(numbers(data["y"])) {}
  [[nodiscard]] double log_density(std::span<const double> x) const override {
    double squares = 0, sum = 0;
    for (std::size_t t = 5; t < y_.size(); ++t) {
      double r = y_[t] - x[0];
      for (std::size_t k = 1; k <= 5; ++k) r -= x[k] * y_[t - k];
      squares += r * r;
    }
    for (std::size_t k = 0; k <= 5; ++k) sum += log_normal(x[k], 0, 10);
    const double sigma = std::exp(x[6]);
    sum += -0.5 * squares / (sigma * sigma) - double(y_.size() - 5) * x[6] + log_cauchy(sigma, 2.5) + x[6];
    return std::isfinite(sum) ? sum : never;
  }
  void constrain(std::span<const double> x, std::span<double> q) const override {
    std::copy(x.begin(), x.end(), q.begin());
    q[6] = std::exp(x[6]);
  }

 private:
  std::vector<double> y_;
};

/// y ~ theta N(mu_1, sigma_1) + (1 - theta) N(mu_2, sigma_2), mu_1 < mu_2; mu, sigma ~ N(0, 2) (sigma > 0), theta ~ Beta(5, 5); Stan case study on mixtures.
/// x: mu_1, ln(mu_2 - mu_1), ln sigma_1, ln sigma_2, logit theta.
class Mixture : public Model {
 public:
  explicit Mixture(const Json& data)
      : Model({"mu1", "ln gap", "ln sigma1", "ln sigma2", "logit theta"}, {"mu[1]", "mu[2]", "sigma[1]", "sigma[2]", "theta"}), y_(numbers(data["y"])) {}
  [[nodiscard]] double log_density(std::span<const double> x) const override {
    double q[5];
    constrain(x, q);
    double sum = log_normal(q[0], 0, 2) + log_normal(q[1], 0, 2) + x[1];
    for (int k : {2, 3}) sum += -0.125 * q[k] * q[k] + x[k];
    sum += 5 * std::log(q[4]) + 5 * std::log1p(-q[4]);  // Beta's powers 4, and the logit's Jacobian theta (1 - theta)
    const double w1 = q[4] / q[2], w2 = (1 - q[4]) / q[3];
    for (const double y : y_) {
      const double a = (y - q[0]) / q[2], b = (y - q[1]) / q[3];
      sum += std::log(w1 * std::exp(-0.5 * a * a) + w2 * std::exp(-0.5 * b * b));
    }
    return std::isfinite(sum) ? sum : never;
  }
  void constrain(std::span<const double> x, std::span<double> q) const override {
    q[0] = x[0], q[1] = x[0] + std::exp(x[1]), q[2] = std::exp(x[2]), q[3] = std::exp(x[3]), q[4] = 1 / (1 + std::exp(-x[4]));
  }

 private:
  std::vector<double> y_;
};

struct Scores {
  double worst = 0;
  std::string where;
  std::size_t checked = 0;
};

Scores scores(const Draws& draws, const Json& reference) {
  Scores s;
  for (const auto& [name, r] : reference.items()) {
    const auto k = std::find(draws.names.begin(), draws.names.end(), name) - draws.names.begin();
    const auto x = draws.of(std::size_t(k));
    for (const auto& [text, value] : r["quantiles"].items()) {
      const double p = std::stod(text), q = value.get<double>();
      double share = 0;
      for (const double v : x) share += double(v <= q) / double(x.size());
      double z = (share - p) / std::sqrt(p * (1 - p) * (1 / ess_indicator({x, draws.chains}, q) + 1e-4));
      if (std::isnan(z)) z = std::numeric_limits<double>::infinity();  // all draws on one side
      ++s.checked;
      if (std::abs(z) > std::abs(s.worst)) s.worst = z, s.where = name + " at " + text;
    }
  }
  return s;
}

Eigen::VectorXd start_of(std::initializer_list<double> x) { return Eigen::Map<const Eigen::VectorXd>(x.begin(), Eigen::Index(x.size())); }

/// Samples and holds the draws against the reference; converged as well, by its own rule.
void follows(const LogDensity& density, const Json& file, const SamplerStart& start, const SamplerOptions& options) {
  const auto r = run_sampler(density, start, options, {.seed = 1, .threads = 4});
  const auto verdict = assess(r.quantities, {.acceptance = r.summary.acceptance[0], .thin = options.thin});
  EXPECT_TRUE(verdict.converged) << verdict.message;
  const Scores s = scores(r.quantities, file["reference"]);
  EXPECT_EQ(s.checked, 5 * file["reference"].size());
  EXPECT_LT(std::abs(s.worst), 4) << s.where;
  ::testing::Test::RecordProperty("worst_z", std::to_string(s.worst));
  std::printf("  %zu quantiles, worst z %.2f (%s); %zu evaluations in %.1f s; acceptance %.2f; %s\n", s.checked, s.worst, s.where.c_str(),
              r.summary.evaluations, r.summary.wall_s, r.summary.acceptance[0], verdict.message.c_str());
}

#define REFERENCE(variable, name)        \
  const Json variable = reference(name); \
  if (variable.is_null()) GTEST_SKIP() << "the reference posteriors are not here: " << folder()

}  // namespace

TEST(Posteriors, DramFollowsEightSchoolsAndADroppedJacobianIsTold) {
  REFERENCE(file, "eight_schools-eight_schools_noncentered.json");
  const SamplerStart start{.mean = Eigen::VectorXd::Zero(10)};
  const SamplerOptions options{.warmup = 20000, .draws = 20000, .thin = 10};
  follows(EightSchools(file["data"], true), file, start, options);
  const auto dropped = run_sampler(EightSchools(file["data"], false), start, options, {.seed = 1, .threads = 4});
  EXPECT_GT(std::abs(scores(dropped.quantities, file["reference"]).worst), 4);
}

TEST(Posteriors, DramFollowsTheInteractionOfKidScores) {
  REFERENCE(file, "kidiq-kidscore_interaction.json");
  follows(KidScores(file["data"]), file, {.mean = start_of({0, 0, 1, 0, 3})}, {.warmup = 20000, .draws = 20000, .thin = 2});
}

TEST(Posteriors, DramFollowsAnAutoregression) {
  REFERENCE(file, "arK-arK.json");
  follows(Autoregression(file["data"]), file, {.mean = start_of({0, 0, 0, 0, 0, 0, -1})}, {.warmup = 10000, .draws = 20000, .thin = 2});
}

TEST(Posteriors, DramFollowsAMixtureOfOrderedMeans) {
  REFERENCE(file, "low_dim_gauss_mix-low_dim_gauss_mix.json");
  follows(Mixture(file["data"]), file, {.mean = start_of({-2, 1, 0, 0, 0}), .covariance = 0.04 * Eigen::MatrixXd::Identity(5, 5)},
          {.warmup = 3000, .draws = 10000});
}
