#include "tests/verification/reference_posteriors.hpp"

#include <array>
#include <cmath>

#include "base/json.hpp"

namespace calomel::testing {

namespace {

using Numbers = std::vector<double>;
using Names = std::vector<std::string>;

double square(double x) { return x * x; }
/// ln N(x; mean, sd) without its constant; its derivative by x is added to `slope`.
double log_normal(double x, double mean, double sd, double& slope) {
  const double r = (x - mean) / sd;
  slope -= r / sd;
  return -0.5 * r * r;
}
/// ln of the half-Cauchy density of e^x, and its derivative by x added to `slope`.
double log_cauchy_of_exp(double x, double scale, double& slope) {
  const double u = square(std::exp(x) / scale);
  slope -= 2 / (1 + 1 / u);
  return -std::log1p(u);
}

Names indexed(const std::string& name, int n) {
  Names names;
  for (int i = 1; i <= n; ++i) names.push_back(name + '[' + std::to_string(i) + ']');
  return names;
}
Names joined(Names a, const Names& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// A model is `coordinates`, `quantities`, ln p(x) with its gradient (left alone where `g` is empty), and constrain(x).
template <class Model>
class Density final : public LogDensity {
 public:
  explicit Density(Model model) : model_(std::move(model)), coordinates_(model_.coordinates()) {}
  [[nodiscard]] const Names& coordinates() const override { return coordinates_; }
  [[nodiscard]] Names quantities() const override { return model_.quantities(); }
  [[nodiscard]] double log_density(std::span<const double> x) const override { return finite_or_never(model_.evaluate(x, {})); }
  [[nodiscard]] bool has_gradient() const override { return true; }
  double log_density_and_gradient(std::span<const double> x, std::span<double> g) const override {
    std::ranges::fill(g, 0.0);
    return finite_or_never(model_.evaluate(x, g));
  }
  void constrain(std::span<const double> x, std::span<double> q) const override { model_.constrain(x, q); }

 private:
  static double finite_or_never(double value) { return std::isfinite(value) ? value : never; }
  Model model_;
  Names coordinates_;
};

/// y_j ~ N(theta_j, sigma_j), theta_j = mu + tau z_j, z_j ~ N(0, 1), mu ~ N(0, 5), tau ~ half-Cauchy(5); Rubin 1981, Gelman et al. 2013, section 5.5. x: mu, ln
/// tau, z.
struct EightSchools {
  Numbers y, sigma;
  double jacobian;

  [[nodiscard]] Names coordinates() const { return joined({"mu", "ln tau"}, indexed("z", 8)); }
  [[nodiscard]] Names quantities() const { return joined({"mu", "tau"}, indexed("theta", 8)); }
  [[nodiscard]] double evaluate(std::span<const double> x, std::span<double> g) const {
    const double tau = std::exp(x[1]);
    double by_mu = 0, by_ln_tau = jacobian, sum = log_normal(x[0], 0, 5, by_mu) + log_cauchy_of_exp(x[1], 5, by_ln_tau) + jacobian * x[1];
    for (std::size_t j = 0; j < 8; ++j) {
      double by_z = 0, by_minus_theta = 0;
      const double theta = x[0] + tau * x[2 + j];
      sum += log_normal(x[2 + j], 0, 1, by_z) + log_normal(y[j], theta, sigma[j], by_minus_theta);
      by_mu -= by_minus_theta;
      by_ln_tau -= by_minus_theta * tau * x[2 + j];
      by_z -= by_minus_theta * tau;
      if (!g.empty()) g[2 + j] = by_z;
    }
    if (!g.empty()) g[0] = by_mu, g[1] = by_ln_tau;
    return sum;
  }
  void constrain(std::span<const double> x, std::span<double> q) const {
    q[0] = x[0];
    q[1] = std::exp(x[1]);
    for (std::size_t j = 0; j < 8; ++j) q[2 + j] = x[0] + q[1] * x[2 + j];
  }
};

/// ln p of residuals r ~ N(0, sigma), sigma = e^x ~ half-Cauchy(2.5), from their sum of squares; its derivative by x into `slope`.
double log_residuals(double squares, std::size_t n, double x, double jacobian, double& slope) {
  const double by_variance = squares * std::exp(-2 * x);
  slope = by_variance - double(n) + jacobian;
  return -0.5 * by_variance - double(n) * x + log_cauchy_of_exp(x, 2.5, slope) + jacobian * x;
}

/// y ~ N(beta . (1, hs, iq, hs iq), sigma), flat beta, sigma ~ half-Cauchy(2.5); Gelman and Hill 2006, section 3.3. x: beta, ln sigma.
struct KidScores {
  Numbers y, hs, iq;
  double jacobian;

  [[nodiscard]] Names coordinates() const { return joined(indexed("beta", 4), {"ln sigma"}); }
  [[nodiscard]] Names quantities() const { return joined(indexed("beta", 4), {"sigma"}); }
  [[nodiscard]] double evaluate(std::span<const double> x, std::span<double> g) const {
    double squares = 0, moments[4] = {};
    for (std::size_t i = 0; i < y.size(); ++i) {
      const double r = y[i] - (x[0] + x[1] * hs[i] + x[2] * iq[i] + x[3] * hs[i] * iq[i]);
      squares += r * r;
      moments[0] += r;
      moments[1] += r * hs[i];
      moments[2] += r * iq[i];
      moments[3] += r * hs[i] * iq[i];
    }
    double by_ln_sigma = 0;
    const double sum = log_residuals(squares, y.size(), x[4], jacobian, by_ln_sigma), precision = std::exp(-2 * x[4]);
    if (!g.empty()) {
      for (std::size_t k = 0; k < 4; ++k) g[k] = moments[k] * precision;
      g[4] = by_ln_sigma;
    }
    return sum;
  }
  void constrain(std::span<const double> x, std::span<double> q) const {
    for (std::size_t k = 0; k < 4; ++k) q[k] = x[k];
    q[4] = std::exp(x[4]);
  }
};

/// y_t ~ N(alpha + sum_k beta_k y_(t-k), sigma), K = 5; alpha, beta ~ N(0, 10), sigma ~ half-Cauchy(2.5); Stan user's guide, autoregressive models. x: alpha,
/// beta, ln sigma.
struct Autoregression {
  Numbers y;
  double jacobian;

  [[nodiscard]] Names coordinates() const { return joined({"alpha"}, joined(indexed("beta", 5), {"ln sigma"})); }
  [[nodiscard]] Names quantities() const { return joined({"alpha"}, joined(indexed("beta", 5), {"sigma"})); }
  [[nodiscard]] double evaluate(std::span<const double> x, std::span<double> g) const {
    double squares = 0, moments[6] = {};
    for (std::size_t t = 5; t < y.size(); ++t) {
      double r = y[t] - x[0];
      for (std::size_t k = 1; k <= 5; ++k) r -= x[k] * y[t - k];
      squares += r * r;
      moments[0] += r;
      for (std::size_t k = 1; k <= 5; ++k) moments[k] += r * y[t - k];
    }
    double by_ln_sigma = 0, sum = log_residuals(squares, y.size() - 5, x[6], jacobian, by_ln_sigma);
    const double precision = std::exp(-2 * x[6]);
    for (std::size_t k = 0; k <= 5; ++k) {
      double slope = moments[k] * precision;
      sum += log_normal(x[k], 0, 10, slope);
      if (!g.empty()) g[k] = slope;
    }
    if (!g.empty()) g[6] = by_ln_sigma;
    return sum;
  }
  void constrain(std::span<const double> x, std::span<double> q) const {
    std::copy(x.begin(), x.end(), q.begin());
    q[6] = std::exp(x[6]);
  }
};

/// y ~ theta N(mu_1, sigma_1) + (1 - theta) N(mu_2, sigma_2), mu_1 < mu_2; mu, sigma ~ N(0, 2) (sigma > 0), theta ~ Beta(5, 5); Stan case study on mixtures.
/// x: mu_1, ln(mu_2 - mu_1), ln sigma_1, ln sigma_2, logit theta.
struct Mixture {
  Numbers y;
  double jacobian;

  [[nodiscard]] Names coordinates() const { return {"mu1", "ln gap", "ln sigma1", "ln sigma2", "logit theta"}; }
  [[nodiscard]] Names quantities() const { return {"mu[1]", "mu[2]", "sigma[1]", "sigma[2]", "theta"}; }
  [[nodiscard]] double evaluate(std::span<const double> x, std::span<double> g) const {
    double q[5];
    constrain(x, q);
    const double gap = std::exp(x[1]), ln_theta = -std::log1p(std::exp(-x[4])), ln_rest = -std::log1p(std::exp(x[4])),
                 power = 4 + jacobian;  // Beta's powers, and theta (1 - theta)
    const double ln_w1 = ln_theta - x[2], ln_w2 = ln_rest - x[3];
    double by_mu[2] = {}, by_ln_sigma[2] = {}, firsts = 0;
    double sum = log_normal(q[0], 0, 2, by_mu[0]) + log_normal(q[1], 0, 2, by_mu[1]) + jacobian * (x[1] + x[2] + x[3]) + power * (ln_theta + ln_rest);
    for (std::size_t k = 0; k < 2; ++k) sum -= 0.125 * square(q[2 + k]), by_ln_sigma[k] = jacobian - 0.25 * square(q[2 + k]);
    double product = 1;  // of 1 + e, each at most 2, whose logarithm is taken now and then
    for (std::size_t i = 0; i < y.size(); ++i) {
      const double a = (y[i] - q[0]) / q[2], b = (y[i] - q[1]) / q[3], l1 = ln_w1 - 0.5 * a * a, l2 = ln_w2 - 0.5 * b * b, e = std::exp(-std::abs(l1 - l2));
      sum += std::max(l1, l2);
      product *= 1 + e;
      if (i % 512 == 511) sum += std::log(product), product = 1;
      if (g.empty()) continue;
      const double first = (l1 > l2 ? 1 : e) / (1 + e), second = 1 - first;  // shares of the two
      firsts += first;
      by_mu[0] += first * a / q[2];
      by_mu[1] += second * b / q[3];
      by_ln_sigma[0] += first * (a * a - 1);
      by_ln_sigma[1] += second * (b * b - 1);
    }
    sum += std::log(product);
    if (!g.empty()) {
      g[0] = by_mu[0] + by_mu[1];
      g[1] = by_mu[1] * gap + jacobian;
      g[2] = by_ln_sigma[0];
      g[3] = by_ln_sigma[1];
      g[4] = power * (1 - 2 * q[4]) + firsts - double(y.size()) * q[4];
    }
    return sum;
  }
  void constrain(std::span<const double> x, std::span<double> q) const {
    q[0] = x[0];
    q[1] = x[0] + std::exp(x[1]);
    q[2] = std::exp(x[2]);
    q[3] = std::exp(x[3]);
    q[4] = 1 / (1 + std::exp(-x[4]));
  }
};

/// Populations u (prey), v (predators) and, behind them, their derivatives by alpha, beta, gamma, delta, u(0), v(0).
template <bool sensitive>
struct Populations {
  static constexpr std::size_t n = 6;
  double u = 0, v = 0;
  std::array<double, sensitive ? n : 0> su{}, sv{};

  /// du/dt = (alpha - beta v) u, dv/dt = (-gamma + delta u) v, and the same differentiated.
  [[nodiscard]] Populations rate(const double* theta) const {
    const double a = theta[0] - theta[1] * v, b = -theta[1] * u, c = theta[3] * v, d = -theta[2] + theta[3] * u;
    Populations r{.u = a * u, .v = d * v};
    if constexpr (sensitive) {
      for (std::size_t j = 0; j < n; ++j) r.su[j] = a * su[j] + b * sv[j], r.sv[j] = c * su[j] + d * sv[j];
      r.su[0] += u;
      r.su[1] -= u * v;
      r.sv[2] -= v;
      r.sv[3] += u * v;
    }
    return r;
  }
  [[nodiscard]] Populations moved(double h, const Populations& rate) const {
    Populations r{.u = u + h * rate.u, .v = v + h * rate.v};
    if constexpr (sensitive)
      for (std::size_t j = 0; j < n; ++j) r.su[j] = su[j] + h * rate.su[j], r.sv[j] = sv[j] + h * rate.sv[j];
    return r;
  }
  /// A step of the classical Runge-Kutta method; its derivatives are exactly those of the step.
  void step(const double* theta, double h) {
    const Populations k1 = rate(theta), k2 = moved(h / 2, k1).rate(theta), k3 = moved(h / 2, k2).rate(theta), k4 = moved(h, k3).rate(theta);
    *this = moved(h / 6, k1).moved(h / 3, k2).moved(h / 3, k3).moved(h / 6, k4);
  }
};

/// ln y_k(t) ~ N(ln z_k(t), sigma_k) of hare and lynx pelts, ln y_k(0) alike, z by Lotka and Volterra's equations; alpha, gamma ~ N(1, 0.5), beta, delta ~
/// N(0.05, 0.05), all positive, ln z(0) ~ N(ln 10, 1), ln sigma ~ N(-1, 1); Carpenter 2018, Stan case study on predators and prey. x: ln of alpha, beta, gamma,
/// delta, z(0), sigma.
struct LotkaVolterra {
  Numbers times, first;
  std::vector<std::array<double, 2>> y;
  int steps;  ///< of a year
  double jacobian;

  [[nodiscard]] Names coordinates() const {
    Names names;
    for (const auto& name : quantities()) names.push_back("ln " + name);
    return names;
  }
  [[nodiscard]] Names quantities() const { return joined(indexed("theta", 4), joined(indexed("z_init", 2), indexed("sigma", 2))); }
  [[nodiscard]] double evaluate(std::span<const double> x, std::span<double> g) const { return g.empty() ? sum<false>(x, g) : sum<true>(x, g); }
  void constrain(std::span<const double> x, std::span<double> q) const {
    for (std::size_t k = 0; k < 8; ++k) q[k] = std::exp(x[k]);
  }

 private:
  template <bool sensitive>
  [[nodiscard]] double sum(std::span<const double> x, std::span<double> g) const {
    double q[8], slope[8] = {}, total = 0;
    constrain(x, q);
    for (const std::size_t k : {0, 1, 2, 3}) {
      double by_theta = 0;
      const bool rate = k % 2 == 0;  // of birth or death; else of an encounter
      total += log_normal(q[k], rate ? 1 : 0.05, rate ? 0.5 : 0.05, by_theta) + jacobian * x[k];
      slope[k] = by_theta * q[k] + jacobian;
    }
    // The log-normal densities have 1 / q in them, which the Jacobian of ln q takes away.
    for (const std::size_t k : {4, 5}) total += log_normal(x[k], std::log(10.0), 1, slope[k]) - (1 - jacobian) * x[k], slope[k] -= 1 - jacobian;
    for (const std::size_t k : {6, 7}) total += log_normal(x[k], -1, 1, slope[k]) - (1 - jacobian) * x[k], slope[k] -= 1 - jacobian;

    const double precision[2] = {1 / square(q[6]), 1 / square(q[7])};
    Populations<sensitive> z{.u = q[4], .v = q[5]};
    if constexpr (sensitive) z.su[4] = 1, z.sv[5] = 1;
    const auto compare = [&](double observed, std::size_t k) {
      const double value = k == 0 ? z.u : z.v, r = std::log(observed / value);
      total -= 0.5 * r * r * precision[k] + x[6 + k];
      if constexpr (sensitive) {
        const auto& s = k == 0 ? z.su : z.sv;
        for (std::size_t j = 0; j < 6; ++j) slope[j] += r * precision[k] / value * s[j] * q[j];
        slope[6 + k] += r * r * precision[k] - 1;
      }
    };
    for (const std::size_t k : {0, 1}) compare(first[k], k);
    double t = 0;
    for (std::size_t i = 0; i < times.size(); ++i) {
      const int n = std::max(1, int(std::lround((times[i] - t) * steps)));
      for (int s = 0; s < n; ++s) z.step(q, (times[i] - t) / n);
      t = times[i];
      if (!(z.u > 0 && z.v > 0 && std::isfinite(z.u) && std::isfinite(z.v))) return never;
      for (const std::size_t k : {0, 1}) compare(y[i][k], k);
    }
    if constexpr (sensitive) std::copy(slope, slope + 8, g.begin());
    return total;
  }
};

/// A density without a quarter of another's ln p: its deviations are greater by the root of 4/3.
class Flatter final : public LogDensity {
 public:
  explicit Flatter(std::unique_ptr<LogDensity> of) : of_(std::move(of)) {}
  [[nodiscard]] const Names& coordinates() const override { return of_->coordinates(); }
  [[nodiscard]] Names quantities() const override { return of_->quantities(); }
  void constrain(std::span<const double> x, std::span<double> q) const override { of_->constrain(x, q); }
  [[nodiscard]] double log_density(std::span<const double> x) const override { return share * of_->log_density(x); }
  [[nodiscard]] bool has_gradient() const override { return true; }
  double log_density_and_gradient(std::span<const double> x, std::span<double> g) const override {
    const double value = share * of_->log_density_and_gradient(x, g);
    for (double& v : g) v *= share;
    return value;
  }

 private:
  static constexpr double share = 0.75;
  std::unique_ptr<LogDensity> of_;
};

template <class Model>
std::unique_ptr<LogDensity> density(Model model) {
  return std::make_unique<Density<Model>>(std::move(model));
}
double factor(Jacobian j) { return j == Jacobian::kept ? 1 : 0; }
Numbers numbers_of(const Json& data, const char* key) { return data.at(key).get<Numbers>(); }

std::unique_ptr<LogDensity> eight_schools(const Json& d, Jacobian j) { return density(EightSchools{numbers_of(d, "y"), numbers_of(d, "sigma"), factor(j)}); }
std::unique_ptr<LogDensity> kid_scores(const Json& d, Jacobian j) {
  return density(KidScores{numbers_of(d, "kid_score"), numbers_of(d, "mom_hs"), numbers_of(d, "mom_iq"), factor(j)});
}
std::unique_ptr<LogDensity> autoregression(const Json& d, Jacobian j) { return density(Autoregression{numbers_of(d, "y"), factor(j)}); }
std::unique_ptr<LogDensity> mixture(const Json& d, Jacobian j) { return density(Mixture{numbers_of(d, "y"), factor(j)}); }
std::unique_ptr<LogDensity> hare_and_lynx(const Json& d, int steps, Jacobian j) {
  return density(LotkaVolterra{numbers_of(d, "ts"), numbers_of(d, "y_init"), d.at("y").get<std::vector<std::array<double, 2>>>(), steps, factor(j)});
}
constexpr int steps_a_year = 10;
std::unique_ptr<LogDensity> hare_and_lynx(const Json& d, Jacobian j) { return hare_and_lynx(d, steps_a_year, j); }

template <std::unique_ptr<LogDensity> (*make)(const Json&, Jacobian)>
std::unique_ptr<LogDensity> flatter(const Json& data) {
  return std::make_unique<Flatter>(make(data, Jacobian::kept));
}
/// A density with two steps a year in place of ten, and flatter.
std::unique_ptr<LogDensity> coarse_hare_and_lynx(const Json& data) { return std::make_unique<Flatter>(hare_and_lynx(data, 2, Jacobian::kept)); }

}  // namespace

std::unique_ptr<LogDensity> lotka_volterra(const Json& data, int steps) { return hare_and_lynx(data, steps, Jacobian::kept); }

const std::vector<ReferencePosterior>& reference_posteriors() {
  static const std::vector<ReferencePosterior> all{
      {"eight_schools", "eight schools, non-centred", "eight_schools-eight_schools_noncentered.json", Numbers(10, 0.0), 1, 2, eight_schools,
       flatter<eight_schools>},
      {"kid_scores", "kidiq, interaction", "kidiq-kidscore_interaction.json", {0, 0, 1, 0, 3}, 1, 2, kid_scores, flatter<kid_scores>},
      {"autoregression", "autoregression of order 5", "arK-arK.json", {0, 0, 0, 0, 0, 0, -1}, 1, 2, autoregression, flatter<autoregression>},
      {"mixture", "mixture with ordered means", "low_dim_gauss_mix-low_dim_gauss_mix.json", {-2.7, 1.7, 0, 0, 0.5}, 0.1, 2, mixture, flatter<mixture>},
      {"lotka_volterra",
       "Lotka-Volterra, hare and lynx",
       "hudson_lynx_hare-lotka_volterra.json",
       {std::log(0.5), std::log(0.03), std::log(0.8), std::log(0.03), std::log(30.0), std::log(5.0), std::log(0.3), std::log(0.3)},
       0.1,
       1,
       hare_and_lynx,
       coarse_hare_and_lynx}};
  return all;
}

const ReferencePosterior& reference_posterior(const std::string& name) {
  for (const auto& p : reference_posteriors())
    if (p.name == name) return p;
  fail_contract("a reference posterior of this name is known", __FILE__, __LINE__);
}

}  // namespace calomel::testing
