#include "uq/sampler/ensemble.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "uq/sampler/sampler_options.hpp"
#include "uq/sampler/start.hpp"

namespace calomel {

std::size_t walkers_of(const WalkerOptions& options, std::size_t d) {
  if (options.walkers == 0) return std::max<std::size_t>(8, 4 * d);
  if (options.walkers % 2 != 0 || std::size_t(options.walkers) < std::max<std::size_t>(4, 2 * d))
    throw InputError({.problem = fmt::format("must be even, and at least {} for {} parameters: fewer walkers move in a plane of their own",
                                             std::max<std::size_t>(4, 2 * d), d),
                      .key = "sampler.ensemble.walkers",
                      .value = std::to_string(options.walkers),
                      .suggestion = "take it out: four times the parameters are the default"});
  return std::size_t(options.walkers);
}

namespace {

constexpr double whole_difference = 0.1;  ///< share of the differences with g = 1 (ter Braak 2006, section 2)
constexpr double relative_sd = 0.1;       ///< relative standard deviation of g

class EnsembleChain final : public MarkovChain {
 public:
  EnsembleChain(const LogDensity& density, const WalkerOptions& options, const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance, double dispersion)
      : density_(density),
        options_(options),
        d_(Eigen::Index(density.dimension())),
        walkers_(walkers_of(options, density.dimension())),
        mean_(mean),
        factor_(covariance_factor(covariance, density.dimension())),
        dispersion_(std::max(dispersion, 1e-3)),
        x_(d_, Eigen::Index(walkers_)),
        log_density_(walkers_, 0.0) {}

  void begin(std::span<const double> x, double log_density) override {
    expect(Eigen::Index(x.size()) == d_ && std::isfinite(log_density), "a chain begins where the density is positive");
    x_.colwise() = Eigen::Map<const Eigen::VectorXd>(x.data(), d_);
    std::ranges::fill(log_density_, log_density);
  }

  Transition step(RandomStream& random, bool learns) override {
    expect(!(frozen_ && learns), "a frozen chain learns no more");
    evaluations_ = 0;
    if (!placed_) place_walkers(random);
    double acceptance = 0;
    const std::size_t half = walkers_ / 2;
    for (std::size_t k = 0; k < walkers_; ++k) {
      const std::size_t others = k < half ? half : 0;
      acceptance += random.uniform() < options_.stretch ? stretch(k, others + random.below(half), random) : differ(k, others, half, random);
    }
    return {.acceptance = acceptance / double(walkers_), .evaluations = evaluations_};
  }

  void freeze() override { frozen_ = true; }
  [[nodiscard]] std::size_t walkers() const override { return walkers_; }
  [[nodiscard]] std::span<const double> position(std::size_t walker) const override { return {x_.col(Eigen::Index(walker)).data(), std::size_t(d_)}; }
  [[nodiscard]] double log_density(std::size_t walker) const override { return log_density_[walker]; }

  [[nodiscard]] bool jumps() const override { return true; }
  void jump(std::size_t walker, std::span<const double> x, double log_density, const Eigen::VectorXd& /*centre*/) override {
    x_.col(Eigen::Index(walker)) = Eigen::Map<const Eigen::VectorXd>(x.data(), d_);
    log_density_[walker] = log_density;
  }

  void save(ByteWriter& out) const override {
    save_matrix(out, x_);
    out.values(log_density_);
    out.value(placed_);
    out.value(frozen_);
  }
  void restore(ByteReader& in) override {
    restore_matrix(in, x_);
    log_density_ = in.values<double>();
    in.into(placed_);
    in.into(frozen_);
  }

 private:
  /// Draws the starts of all walkers but the first, which begins where the chain does.
  void place_walkers(RandomStream& random) {
    const auto value = [&](const Eigen::VectorXd& x) {
      ++evaluations_;
      return checked_log_density(density_, x);
    };
    for (std::size_t k = 1; k < walkers_; ++k) {
      const auto b = drawn_beginning(value, mean_, factor_, dispersion_, random, fmt::format("walker {}", k + 1));
      x_.col(Eigen::Index(k)) = b.x;
      log_density_[k] = b.log_density;
    }
    placed_ = true;
  }

  /// Moves walker k to y with the probability min(1, f p(y) / p(x)), which it returns.
  double accept(std::size_t k, const Eigen::VectorXd& y, double log_factor, RandomStream& random) {
    const double value = checked_log_density(density_, y);
    ++evaluations_;
    const double a = std::exp(std::min(0.0, log_factor + value - log_density_[k]));
    if (random.uniform() < a) {
      x_.col(Eigen::Index(k)) = y;
      log_density_[k] = value;
    }
    return a;
  }

  double stretch(std::size_t k, std::size_t j, RandomStream& random) {
    const double a = options_.scale;
    const double z = std::pow(1 + (a - 1) * random.uniform(), 2) / a;  // by the inverse of its distribution function
    const Eigen::VectorXd y = x_.col(Eigen::Index(j)) + z * (x_.col(Eigen::Index(k)) - x_.col(Eigen::Index(j)));
    return accept(k, y, double(d_ - 1) * std::log(z), random);
  }

  double differ(std::size_t k, std::size_t others, std::size_t half, RandomStream& random) {
    const std::size_t i = random.below(half);
    const std::size_t j = (i + 1 + random.below(half - 1)) % half;
    const double g = random.uniform() < whole_difference ? 1 : 2.38 / std::sqrt(2 * double(d_)) * (1 + relative_sd * random.normal());
    const Eigen::VectorXd y = x_.col(Eigen::Index(k)) + g * (x_.col(Eigen::Index(others + i)) - x_.col(Eigen::Index(others + j)));
    return accept(k, y, 0, random);
  }

  const LogDensity& density_;
  WalkerOptions options_;
  Eigen::Index d_;
  std::size_t walkers_;
  Eigen::VectorXd mean_;
  Eigen::MatrixXd factor_;
  double dispersion_;
  Eigen::MatrixXd x_;  ///< (d, walkers)
  std::vector<double> log_density_;
  bool placed_ = false;
  bool frozen_ = false;
  int evaluations_ = 0;  ///< evaluations of one transition
};

}  // namespace

std::unique_ptr<MarkovChain> ensemble_chain(const LogDensity& density, const WalkerOptions& options, const Eigen::VectorXd& mean,
                                            const Eigen::MatrixXd& covariance, double dispersion) {
  return std::make_unique<EnsembleChain>(density, options, mean, covariance, dispersion);
}

SamplerEntry ensemble_sampler() {
  return {.chain =
              [](const ChainSetting& s) {
                return ensemble_chain(s.density, s.options.table<WalkerOptions>(), s.mode.mean, s.mode.covariance, s.options.dispersion);
              },
          .evaluations = [](const SamplerOptions& o, std::size_t d) { return double(walkers_of(o.table<WalkerOptions>(), d)); },
          .lengths = {.warmup = 1000, .draws = 1500, .thin = 10},
          .options = WalkerOptions{},
          .check = [](const SamplerOptions& o, std::size_t d) { (void)walkers_of(o.table<WalkerOptions>(), d); }};
}

}  // namespace calomel
