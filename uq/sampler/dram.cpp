#include "uq/sampler/dram.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/linear_algebra.hpp"
#include "uq/sampler/sampler_options.hpp"
#include "uq/sampler/start.hpp"

namespace calomel {

namespace {

/// ln(1 - exp(a)), a <= 0.
double log_complement(double a) {
  if (a >= 0) return never;
  return a > -0.6931471805599453 ? std::log(-std::expm1(a)) : std::log1p(-std::exp(a));
}

/// ln a_i of the path through the points order[0], ..., order[i].
double log_acceptance_of(std::span<const std::size_t> order, std::span<const double> log_density, const Eigen::MatrixXd& whitened, double shrink) {
  const std::size_t i = order.size() - 1;
  if (log_density[order[i]] == never) return never;
  std::vector<std::size_t> back(order.rbegin(), order.rend());
  // One side of the ratio: ln p of the first point, and the proposals from it that were refused.
  const auto side = [&](std::span<const std::size_t> path) {
    double sum = log_density[path[0]];
    for (std::size_t j = 1; j < i; ++j) {
      sum += -0.5 * (whitened.col(Eigen::Index(path[j])) - whitened.col(Eigen::Index(path[0]))).squaredNorm() / std::pow(shrink, 2.0 * double(j - 1));
      sum += log_complement(log_acceptance_of(path.first(j + 1), log_density, whitened, shrink));
      if (sum == never) return never;
    }
    return sum;
  };
  const double numerator = side(back);
  if (numerator == never) return never;
  return std::min(0.0, numerator - side(order));
}

/// Running mean and sums of squares of draws (Welford 1962).
struct Moments {
  double n = 0;
  Eigen::VectorXd mean;
  Eigen::MatrixXd squares;  ///< sum of (x - mean)(x - mean)^T
  explicit Moments(Eigen::Index d) : mean(Eigen::VectorXd::Zero(d)), squares(Eigen::MatrixXd::Zero(d, d)) {}
  void add(const Eigen::VectorXd& x) {
    n += 1;
    const Eigen::VectorXd before = x - mean;
    mean += before / n;
    squares.noalias() += before * (x - mean).transpose();
  }
  /// The moments of both sets of draws together.
  [[nodiscard]] Moments with(const Moments& other) const {
    Moments m(mean.size());
    m.n = n + other.n;
    if (m.n == 0) return m;
    const Eigen::VectorXd apart = other.mean - mean;
    m.mean = mean + apart * (other.n / m.n);
    m.squares = squares + other.squares + apart * apart.transpose() * (n * other.n / m.n);
    return m;
  }
  void save(ByteWriter& out) const {
    out.value(n);
    out.values(std::span<const double>(mean.data(), std::size_t(mean.size())));
    out.values(std::span<const double>(squares.data(), std::size_t(squares.size())));
  }
  void restore(ByteReader& in) {
    n = in.value<double>();
    const auto m = in.values<double>();
    const auto s = in.values<double>();
    expect(m.size() == std::size_t(mean.size()) && s.size() == std::size_t(squares.size()), "a saved chain has the dimension of its density");
    std::copy(m.begin(), m.end(), mean.data());
    std::copy(s.begin(), s.end(), squares.data());
  }
};

class DramChain final : public MarkovChain {
 public:
  DramChain(const LogDensity& density, const DramOptions& options, const Eigen::MatrixXd& covariance)
      : density_(density),
        options_(options),
        d_(Eigen::Index(density.dimension())),
        x_(d_),
        centre_(Eigen::VectorXd::Zero(d_)),
        shape_(covariance),
        former_(covariance),
        older_(d_),
        newer_(d_) {
    expect(covariance.rows() == d_ && covariance.cols() == d_, "the covariance has the dimension of the density");
    if (!covariance.allFinite() || !factorise())
      throw InputError({.problem = "the covariance that the chains start from is not positive definite", .suggestion = "give one that is, or none"});
  }

  void begin(std::span<const double> x, double log_density) override {
    expect(Eigen::Index(x.size()) == d_ && std::isfinite(log_density), "a chain begins where the density is positive");
    std::copy(x.begin(), x.end(), x_.data());
    log_density_ = log_density;
  }

  Transition step(RandomStream& random, bool learns) override {
    const auto stages = std::size_t(options_.stages);
    Eigen::MatrixXd whitened = Eigen::MatrixXd::Zero(d_, Eigen::Index(stages) + 1);
    std::vector<double> values{log_density_};
    std::vector<std::size_t> order{0};
    Transition result;
    double first = 0;    // acceptance probability of the first stage
    double refused = 1;  // probability that all stages so far were refused
    for (std::size_t i = 1; i <= stages; ++i) {
      const double length = std::pow(options_.shrink, double(i - 1));
      for (Eigen::Index k = 0; k < d_; ++k) whitened(k, Eigen::Index(i)) = length * random.normal();
      const Eigen::VectorXd y = x_ + factor_.triangularView<Eigen::Lower>() * whitened.col(Eigen::Index(i));
      const double value = checked_log_density(density_, y);
      ++result.evaluations;
      values.push_back(value);
      order.push_back(i);
      const double a = std::exp(log_acceptance_of(order, values, whitened, options_.shrink));
      if (i == 1) first = a;
      refused *= 1 - a;
      if (random.uniform() < a) {
        x_ = y;
        log_density_ = value;
        break;
      }
    }
    result.acceptance = 1 - refused;
    if (learns) learn(first);
    return result;
  }

  void freeze() override { frozen_ = true; }
  [[nodiscard]] std::span<const double> position(std::size_t /*walker*/) const override { return {x_.data(), std::size_t(d_)}; }
  [[nodiscard]] double log_density(std::size_t /*walker*/) const override { return log_density_; }

  [[nodiscard]] bool jumps() const override { return true; }
  void jump(std::size_t /*walker*/, std::span<const double> x, double log_density, const Eigen::VectorXd& centre) override {
    begin(x, log_density);
    centre_ = centre;
  }

  void save(ByteWriter& out) const override {
    out.values(position(0));
    save_matrix(out, centre_);
    out.value(log_density_);
    out.value(log_scale_);
    out.value(learned_);
    out.value(doubling_);
    out.value(frozen_);
    for (const auto* m : {&shape_, &former_, &factor_}) out.values(std::span<const double>(m->data(), std::size_t(m->size())));
    older_.save(out);
    newer_.save(out);
  }
  void restore(ByteReader& in) override {
    const auto take = [&](double* to, Eigen::Index n) {
      const auto v = in.values<double>();
      expect(Eigen::Index(v.size()) == n, "a saved chain has the dimension of its density");
      std::copy(v.begin(), v.end(), to);
    };
    take(x_.data(), d_);
    restore_matrix(in, centre_);
    in.into(log_density_);
    in.into(log_scale_);
    in.into(learned_);
    in.into(doubling_);
    in.into(frozen_);
    for (auto* m : {&shape_, &former_, &factor_}) take(m->data(), d_ * d_);
    older_.restore(in);
    newer_.restore(in);
  }

 private:
  /// Computes the factor of s (2.38^2 / d) S. Returns false and leaves the factor unchanged when S is not positive definite.
  bool factorise() {
    const Cholesky cholesky(shape_);
    if (!cholesky.positive_definite()) return false;
    const Eigen::MatrixXd lower = cholesky.lower();
    if (!lower.allFinite()) return false;
    factor_ = std::exp(0.5 * log_scale_) * 2.38 / std::sqrt(double(d_)) * lower;
    return true;
  }

  void learn(double first) {
    expect(!frozen_, "a frozen chain learns no more");
    learned_ += 1;
    newer_.add(x_ - centre_);
    log_scale_ += std::pow(learned_, -0.6) * (first - (0.234 + 0.206 / double(d_)));
    if (int(learned_) % options_.adapt_every != 0) return;
    const Moments all = older_.with(newer_);
    const double weight = 2 * double(d_);
    const Eigen::MatrixXd estimate = (all.squares + weight * former_) / (all.n + weight);
    shape_ = 0.5 * (estimate + estimate.transpose());
    if (newer_.n >= doubling_ && newer_.n >= 10 * double(d_)) {  // forget all but the newer half
      former_ = shape_;
      older_ = newer_;
      newer_ = Moments(d_);
      doubling_ *= 2;
    }
    factorise();
  }

  const LogDensity& density_;
  DramOptions options_;
  Eigen::Index d_;
  Eigen::VectorXd x_;
  double log_density_ = 0;
  Eigen::VectorXd centre_;  ///< the point about which the draws' moments are taken
  Eigen::MatrixXd shape_;   ///< S
  Eigen::MatrixXd former_;  ///< S at the last doubling
  Eigen::MatrixXd factor_;  ///< lower triangular factor of C
  double log_scale_ = 0;    ///< ln s
  double learned_ = 0;      ///< transitions of the warm-up so far
  double doubling_ = 100;   ///< transitions after which the older draws are forgotten next
  bool frozen_ = false;
  Moments older_;
  Moments newer_;
};

}  // namespace

double log_delayed_acceptance(std::span<const double> log_density, const Eigen::MatrixXd& whitened, double shrink) {
  expect(log_density.size() >= 2 && Eigen::Index(log_density.size()) == whitened.cols(), "a path has a value at each of its points");
  std::vector<std::size_t> order(log_density.size());
  std::iota(order.begin(), order.end(), 0);
  return log_acceptance_of(order, log_density, whitened, shrink);
}

std::unique_ptr<MarkovChain> dram_chain(const LogDensity& density, const DramOptions& options, const Eigen::MatrixXd& covariance) {
  return std::make_unique<DramChain>(density, options, covariance);
}

SamplerEntry dram_sampler() {
  constexpr double usual = 1.7;  // proposals of a transition
  return {.chain = [](const ChainSetting& s) { return dram_chain(s.density, s.options.table<DramOptions>(), s.mode.covariance); },
          .evaluations = [](const SamplerOptions&, std::size_t) { return usual; },
          .lengths = {.warmup = 5000, .draws = 10000, .thin = 4},
          .external_lengths = ChainLengths{.warmup = 4000, .draws = 4000, .thin = 4},
          .options = DramOptions{}};
}

}  // namespace calomel
