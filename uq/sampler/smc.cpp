#include "uq/sampler/smc.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/linear_algebra.hpp"
#include "base/log_sum.hpp"
#include "uq/sampler/sampler_options.hpp"
#include "uq/sampler/start.hpp"
#include "uq/sampler/student.hpp"

namespace calomel {

namespace {

constexpr double resample_below = 0.5;   ///< effective share of the particles below which they are resampled
constexpr double few = 10;               ///< effective number of particles of a part below which its correlation is not computed
constexpr double smallest_step = 1e-12;  ///< least step of b, taken even where it does not keep enough particles

class SmcChain final : public MarkovChain {
 public:
  SmcChain(const LogDensity& density, const SmcOptions& options, const std::vector<StartMode>& modes, double dispersion, std::size_t particles)
      : density_(density),
        options_(options),
        d_(Eigen::Index(density.dimension())),
        n_(Eigen::Index(particles)),
        reference_(modes, std::max(dispersion, 1e-3)),
        log_scale_(Eigen::VectorXd::Zero(Eigen::Index(modes.size()))),
        first_(modes.at(0).mean),
        x_(Eigen::MatrixXd::Zero(d_, n_)),
        before_(Eigen::MatrixXd::Zero(d_, n_)),
        log_p_(Eigen::VectorXd::Zero(n_)),
        log_q_(Eigen::VectorXd::Zero(n_)),
        weights_(Eigen::VectorXd::Constant(n_, 1 / double(n_))) {
    expect(n_ > 0, "a population has particles");
    for (std::size_t k = 0; k < reference_.parts(); ++k) factors_.push_back(reference_.part(k).factor());
  }

  void begin(std::span<const double> x, double log_density) override {
    expect(Eigen::Index(x.size()) == d_ && std::isfinite(log_density), "a chain begins where the density is positive");
    std::copy(x.begin(), x.end(), first_.data());
    first_log_density_ = log_density;
  }

  Transition step(RandomStream& random, bool learns) override {
    const Eigen::Index before = total_;
    if (learns) {
      expect(!frozen_, "a frozen chain learns no more");
      if (!arrived()) advance(random);
    } else {
      while (!arrived()) advance(random);
      expect(returned_ < n_, "each particle is returned once");
      ++returned_;
    }
    return {.acceptance = acceptance_, .evaluations = int(total_ - before)};
  }

  void freeze() override { frozen_ = true; }
  [[nodiscard]] std::span<const double> position(std::size_t /*walker*/) const override {
    return returned_ > 0 ? std::span<const double>(x_.col(returned_ - 1).data(), std::size_t(d_)) : std::span<const double>(first_.data(), std::size_t(d_));
  }
  [[nodiscard]] double log_density(std::size_t /*walker*/) const override { return returned_ > 0 ? log_p_[returned_ - 1] : first_log_density_; }
  [[nodiscard]] std::optional<double> log_evidence() const override { return arrived() ? std::optional(log_evidence_) : std::nullopt; }

  void save(ByteWriter& out) const override {
    for (const double v : {first_log_density_, b_, log_evidence_, acceptance_}) out.value(v);
    out.value(returned_);
    out.value(total_);
    out.value(sweeps_);
    out.value(drawn_);
    out.value(moving_);
    out.value(frozen_);
    for (const Eigen::MatrixXd* m : {&x_, &before_}) save_matrix(out, *m);
    for (const Eigen::MatrixXd& m : factors_) save_matrix(out, m);
    for (const Eigen::VectorXd* v : {&log_scale_, &first_, &log_p_, &log_q_, &weights_}) save_matrix(out, *v);
  }
  void restore(ByteReader& in) override {
    for (double* v : {&first_log_density_, &b_, &log_evidence_, &acceptance_}) in.into(*v);
    in.into(returned_);
    in.into(total_);
    in.into(sweeps_);
    in.into(drawn_);
    in.into(moving_);
    in.into(frozen_);
    for (Eigen::MatrixXd* m : {&x_, &before_}) restore_matrix(in, *m);
    for (Eigen::MatrixXd& m : factors_) restore_matrix(in, m);
    for (Eigen::VectorXd* v : {&log_scale_, &first_, &log_p_, &log_q_, &weights_}) restore_matrix(in, *v);
    if (drawn_) find_parts();  // particles do not leave them
  }

 private:
  [[nodiscard]] bool arrived() const { return b_ == 1 && !moving_; }

  /// Draws the particles' first places, or makes one sweep; a new temperature precedes the sweep where the last one is finished.
  void advance(RandomStream& random) {
    if (!drawn_) return draw(random);
    if (total_ >= options_.evaluations)
      throw NumericsError(
          fmt::format("a population of {} particles has used its {} evaluations at temperature {:.3g} (1 is the density), so it has no draws yet; increase "
                      "sampler.smc.evaluations and repeat the command, which resumes, give starts nearer to the density, or use \"nuts\" or \"dram\", which "
                      "follow narrow ridges better",
                      n_, options_.evaluations, b_));
    if (!moving_) warm(random);
    sweep(random);
    if (sweeps_ >= options_.sweeps || correlation() <= options_.correlation) moving_ = false;
  }

  void draw(RandomStream& random) {
    for (Eigen::Index i = 0; i < n_; ++i) {
      x_.col(i) = reference_.choose(random).draw(random);
      log_q_[i] = reference_.log_density(x_.col(i));
      log_p_[i] = checked_log_density(density_, x_.col(i));
      ++total_;
    }
    if ((log_p_.array() == never).all())
      throw NumericsError(
          "the density is zero at all particles that were drawn about the given mean; give a mean and a covariance nearer to where it is positive");
    drawn_ = true;
  }

  /// The logarithms of the factors by which weights grow in a step.
  [[nodiscard]] std::vector<double> growth(double step) const {
    std::vector<double> logs(std::size_t(n_), never);
    for (Eigen::Index i = 0; i < n_; ++i)
      if (log_p_[i] != never) logs[std::size_t(i)] = step * (log_p_[i] - log_q_[i]);
    return logs;
  }
  [[nodiscard]] std::span<const double> weights() const { return {weights_.data(), std::size_t(n_)}; }

  /// The effective share of the particles after a step.
  [[nodiscard]] double kept(double step) const {
    auto logs = growth(step);
    const double sum = log_sum(logs, weights());
    for (double& l : logs) l *= 2;
    return std::exp(2 * sum - log_sum(logs, weights()));
  }

  /// Takes the next temperature: weights, evidence, resampling, and the covariance by which particles move.
  void warm(RandomStream& random) {
    double step = 1 - b_;
    if (kept(step) < options_.keep) {
      double low = 0;
      double high = step;
      for (int i = 0; i < 60; ++i) {
        step = 0.5 * (low + high);
        (kept(step) < options_.keep ? high : low) = step;
      }
      step = std::max(low, std::min(smallest_step, 1 - b_));
    }
    const auto logs = growth(step);
    log_evidence_ += log_sum(logs, weights());
    const auto grown = shares(logs, weights());
    weights_ = Eigen::Map<const Eigen::VectorXd>(grown.data(), n_);
    b_ = step >= 1 - b_ ? 1 : b_ + step;
    if (b_ == 1 || 1 / weights_.squaredNorm() < resample_below * double(n_)) resample(random);
    learn_shape();
    before_ = x_;
    sweeps_ = 0;
    moving_ = true;
  }

  /// Resamples systematically and in order: particle i has as many offspring as a comb of N teeth, one apart, has teeth in its share.
  void resample(RandomStream& random) {
    const double offset = random.uniform();
    std::vector<Eigen::Index> parents;
    double sum = 0;
    for (Eigen::Index i = 0; i < n_; ++i) {
      sum += weights_[i] * double(n_);
      while (Eigen::Index(parents.size()) < n_ && double(parents.size()) + offset < sum) parents.push_back(i);
    }
    Eigen::Index last = n_ - 1;  // rounding may leave the last teeth without a parent
    while (weights_[last] == 0) --last;
    parents.resize(std::size_t(n_), last);
    x_ = Eigen::MatrixXd(x_(Eigen::all, parents));
    log_p_ = Eigen::VectorXd(log_p_(parents));
    log_q_ = Eigen::VectorXd(log_q_(parents));
    weights_.setConstant(1 / double(n_));
  }

  void find_parts() {
    part_.resize(std::size_t(n_));
    for (Eigen::Index i = 0; i < n_; ++i) part_[std::size_t(i)] = reference_.part_of(x_.col(i));
  }

  /// Takes the covariance of each part about its own middle. Particles do not leave their part, so that it holds until the next temperature.
  void learn_shape() {
    find_parts();
    for (std::size_t k = 0; k < factors_.size(); ++k) {
      const Eigen::VectorXd w = weights_of(k);
      if (!(w.sum() > 0)) continue;
      const Eigen::MatrixXd apart = x_.colwise() - x_ * w;
      Eigen::MatrixXd s = apart * w.asDiagonal() * apart.transpose();
      const double effective = 1 / w.squaredNorm();
      const Eigen::VectorXd variances = s.diagonal();
      s *= effective / (effective + double(d_));  // the off-diagonal is shrunk, so that few particles give a positive definite matrix
      s.diagonal() = variances;
      const Cholesky cholesky(0.5 * (s + s.transpose()));
      if (cholesky.positive_definite() && cholesky.lower().allFinite()) factors_[k] = cholesky.lower();
    }
  }

  /// The weights of the particles of one part, which sum to 1; all are 0 where no particle of the part has a weight.
  [[nodiscard]] Eigen::VectorXd weights_of(std::size_t part) const {
    Eigen::VectorXd w = weights_;
    for (Eigen::Index i = 0; i < n_; ++i)
      if (part_[std::size_t(i)] != part) w[i] = 0;
    if (factors_.size() > 1 && w.sum() > 0) w /= w.sum();
    return w;
  }

  [[nodiscard]] double tempered(double log_p, double log_q) const { return log_p == never ? never : (1 - b_) * log_q + b_ * log_p; }

  void sweep(RandomStream& random) {
    std::vector<Eigen::MatrixXd> steps;
    for (std::size_t k = 0; k < factors_.size(); ++k) steps.push_back(std::exp(0.5 * log_scale_[Eigen::Index(k)]) * 2.38 / std::sqrt(double(d_)) * factors_[k]);
    Eigen::VectorXd z(d_);
    Eigen::VectorXd y(d_);
    Eigen::VectorXd accepted = Eigen::VectorXd::Zero(log_scale_.size());
    Eigen::VectorXd tried = accepted;
    acceptance_ = 0;
    for (Eigen::Index i = 0; i < n_; ++i) {
      for (double& v : z) v = random.normal();
      const double u = random.uniform();
      const std::size_t part = part_[std::size_t(i)];
      tried[Eigen::Index(part)] += 1;
      if (log_p_[i] == never) continue;  // it has no weight and no offspring
      y = x_.col(i) + steps[part] * z;
      if (steps.size() > 1 && reference_.part_of(y) != part) continue;  // each part moves by its own covariance, so a step out of it has no reverse
      const double log_p = checked_log_density(density_, y);
      const double log_q = reference_.log_density(y);
      ++total_;
      const double a = std::exp(std::min(0.0, tempered(log_p, log_q) - tempered(log_p_[i], log_q_[i])));
      acceptance_ += a / double(n_);
      accepted[Eigen::Index(part)] += a;
      if (u < a) {
        x_.col(i) = y;
        log_p_[i] = log_p;
        log_q_[i] = log_q;
      }
    }
    for (Eigen::Index k = 0; k < log_scale_.size(); ++k)
      if (tried[k] > 0) log_scale_[k] += accepted[k] / tried[k] - (0.234 + 0.206 / double(d_));
    ++sweeps_;
  }

  /// The correlation of the particles' places with those before the sweeps, the greatest over coordinates and parts.
  [[nodiscard]] double correlation() const {
    double greatest = 0;
    for (std::size_t part = 0; part < factors_.size(); ++part) {
      const Eigen::VectorXd w = weights_of(part);
      if (factors_.size() > 1 && !(1 / w.squaredNorm() > few)) continue;
      for (Eigen::Index k = 0; k < d_; ++k) {
        const Eigen::ArrayXd a = x_.row(k).array() - x_.row(k).dot(w);
        const Eigen::ArrayXd b = before_.row(k).array() - before_.row(k).dot(w);
        const double both = std::sqrt((w.array() * a.square()).sum() * (w.array() * b.square()).sum());
        if (both > 0) greatest = std::max(greatest, (w.array() * a * b).sum() / both);
      }
    }
    return greatest;
  }

  const LogDensity& density_;
  SmcOptions options_;
  Eigen::Index d_;
  Eigen::Index n_;
  StudentMixture reference_;              ///< q
  std::vector<Eigen::MatrixXd> factors_;  ///< (parts of q) factor of S
  Eigen::VectorXd log_scale_;             ///< (parts of q) ln s
  std::vector<std::size_t> part_;         ///< (N) the part of q that a particle is in
  Eigen::VectorXd first_;                 ///< the start of the chain, from which particles do not begin
  double first_log_density_ = 0;
  Eigen::MatrixXd x_;       ///< (d, N) places
  Eigen::MatrixXd before_;  ///< (d, N) places when the temperature began
  Eigen::VectorXd log_p_;
  Eigen::VectorXd log_q_;
  Eigen::VectorXd weights_;
  double b_ = 0;
  double log_evidence_ = 0;
  double acceptance_ = 0;      ///< of the last sweep
  Eigen::Index returned_ = 0;  ///< particles returned so far
  Eigen::Index total_ = 0;     ///< evaluations so far
  int sweeps_ = 0;             ///< sweeps at this temperature
  bool drawn_ = false;
  bool moving_ = false;
  bool frozen_ = false;
};

}  // namespace

std::unique_ptr<MarkovChain> smc_chain(const LogDensity& density, const SmcOptions& options, const std::vector<StartMode>& modes, double dispersion,
                                       std::size_t particles) {
  return std::make_unique<SmcChain>(density, options, modes, dispersion, particles);
}

SamplerEntry smc_sampler() {
  constexpr double usual = 40;  // moves of a particle, over some twenty temperatures
  return {.chain =
              [](const ChainSetting& s) {
                return smc_chain(s.density, s.options.table<SmcOptions>(), s.modes, s.options.dispersion,
                                 std::size_t(s.options.draws) * std::size_t(s.options.thin));
              },
          .evaluations = [](const SamplerOptions& o, std::size_t) { return usual * double(o.draws) * o.thin / (double(o.warmup) + double(o.draws) * o.thin); },
          .lengths = {.warmup = 1000, .draws = 2000, .thin = 1},
          .options = SmcOptions{},
          .limits = {"evaluations"},
          .remedies = {.correlation_key = "sampler.smc.correlation"}};
}

}  // namespace calomel
