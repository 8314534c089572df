#include "uq/sampler/delayed_acceptance.hpp"

#include <algorithm>
#include <cmath>

#include "uq/sampler/sampler_options.hpp"
#include "uq/sampler/start.hpp"

namespace calomel {

namespace {

class DelayedAcceptanceChain final : public MarkovChain {
 public:
  DelayedAcceptanceChain(const LogDensity& cheap, const LogDensity& exact, const DelayedAcceptanceOptions& options, const DramOptions& dram,
                         const Eigen::MatrixXd& covariance, int warmup)
      : exact_(exact),
        options_(options),
        alone_(std::max(0, warmup - options.settle)),
        d_(Eigen::Index(cheap.dimension())),
        first_stage_(dram_chain(cheap, dram, covariance)),
        x_(d_) {
    expect(exact.dimension() == cheap.dimension(), "both densities have the same coordinates");
  }

  void begin(std::span<const double> x, double log_density) override {
    first_stage_->begin(x, log_density);
    std::copy(x.begin(), x.end(), x_.data());
    log_cheap_ = log_density;
  }

  Transition step(RandomStream& random, bool learns) override {
    expect(!(frozen_ && learns), "a frozen chain learns no more");
    Transition result;
    if (learns && learned_ < alone_) {
      ++learned_;
      result.acceptance = propose(random, true, result);
      take(first_stage_->position(0), first_stage_->log_density(0), never);
      return result;
    }
    if (!uses_exact_) {
      first_stage_->freeze();
      log_exact_ = exact_at(x_, result);
      uses_exact_ = true;
    }
    first_stage_->begin({x_.data(), std::size_t(d_)}, log_cheap_);
    propose(random, false, result);
    const auto y = first_stage_->position(0);
    const double log_cheap = first_stage_->log_density(0);
    const double u = random.uniform();
    if (std::equal(y.begin(), y.end(), x_.data())) return result;
    const double log_exact = exact_at(Eigen::Map<const Eigen::VectorXd>(y.data(), d_), result);
    result.acceptance = log_exact == never ? 0 : log_exact_ == never ? 1 : std::exp(std::min(0.0, (log_exact - log_cheap) - (log_exact_ - log_cheap_)));
    if (u < result.acceptance) take(y, log_cheap, log_exact);
    if (!learns && log_exact_ == never)
      throw NumericsError(
          "the exact density is zero where the cheap one has led a chain and at its proposals; narrow the bounds to where the exact one is positive, or raise "
          "sampler.delayed_acceptance.settle");
    return result;
  }

  void freeze() override { frozen_ = true; }
  [[nodiscard]] std::span<const double> position(std::size_t /*walker*/) const override { return {x_.data(), std::size_t(d_)}; }
  [[nodiscard]] double log_density(std::size_t /*walker*/) const override { return uses_exact_ ? log_exact_ : log_cheap_; }

  void save(ByteWriter& out) const override {
    first_stage_->save(out);
    save_matrix(out, x_);
    out.value(log_cheap_);
    out.value(log_exact_);
    out.value(learned_);
    out.value(uses_exact_);
    out.value(frozen_);
  }
  void restore(ByteReader& in) override {
    first_stage_->restore(in);
    restore_matrix(in, x_);
    in.into(log_cheap_);
    in.into(log_exact_);
    in.into(learned_);
    in.into(uses_exact_);
    in.into(frozen_);
  }

 private:
  /// Makes the first stage's transitions. Returns their mean acceptance.
  double propose(RandomStream& random, bool learns, Transition& result) {
    double acceptance = 0;
    for (int i = 0; i < options_.first_stage; ++i) {
      const auto step = first_stage_->step(random, learns);
      acceptance += step.acceptance / options_.first_stage;
      result.cheap_evaluations += step.evaluations;
    }
    return acceptance;
  }

  double exact_at(const Eigen::VectorXd& x, Transition& result) const {
    ++result.evaluations;
    return checked_log_density(exact_, x);
  }

  void take(std::span<const double> x, double log_cheap, double log_exact) {
    std::copy(x.begin(), x.end(), x_.data());
    log_cheap_ = log_cheap;
    log_exact_ = log_exact;
  }

  const LogDensity& exact_;
  DelayedAcceptanceOptions options_;
  int alone_;  ///< number of transitions on the cheap density alone
  Eigen::Index d_;
  std::unique_ptr<MarkovChain> first_stage_;
  Eigen::VectorXd x_;
  double log_cheap_ = 0;
  double log_exact_ = never;
  int learned_ = 0;
  bool uses_exact_ = false;
  bool frozen_ = false;
};

}  // namespace

std::unique_ptr<MarkovChain> delayed_acceptance_chain(const LogDensity& cheap, const LogDensity& exact, const DelayedAcceptanceOptions& options,
                                                      const DramOptions& dram, const Eigen::MatrixXd& covariance, int warmup) {
  return std::make_unique<DelayedAcceptanceChain>(cheap, exact, options, dram, covariance, warmup);
}

SamplerEntry delayed_acceptance_sampler() {
  return {.chain =
              [](const ChainSetting& s) {
                return delayed_acceptance_chain(s.density, *s.exact, s.options.table<DelayedAcceptanceOptions>(), s.options.table<DramOptions>(),
                                                s.mode.covariance, s.options.warmup);
              },
          .evaluations =
              [](const SamplerOptions& o, std::size_t) {
                const double kept = double(o.draws) * o.thin;
                return (double(o.table<DelayedAcceptanceOptions>().settle) + kept) / (double(o.warmup) + kept);
              },
          .lengths = {.warmup = 500, .draws = 300, .thin = 1},
          .options = DelayedAcceptanceOptions{},
          .first_stage = "dram",
          .remedies = {.emulator_only = "dram"}};
}

}  // namespace calomel
