#include "uq/sampler/nuts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/linear_algebra.hpp"
#include "uq/sampler/sampler_options.hpp"
#include "uq/sampler/start.hpp"

namespace calomel {

namespace {

constexpr double divergent_energy = 1000;  ///< error of the energy beyond which a trajectory diverges (Stan's)
constexpr double shrinkage = 5;            ///< number of draws, beside one a dimension, by which a covariance is shrunk to its diagonal
// Dual averaging, as published (Hoffman and Gelman 2014, section 3.2.1).
constexpr double gamma_ = 0.05;
constexpr double t0 = 10;
constexpr double kappa = 0.75;

double log_add(double a, double b) {
  if (a == never) return b;
  if (b == never) return a;
  return std::max(a, b) + std::log1p(std::exp(-std::abs(a - b)));
}

/// A point of a trajectory, in coordinates z in which S is 1.
struct Place {
  Eigen::VectorXd z;
  Eigen::VectorXd p;
  Eigen::VectorXd gradient;
  double log_density = never;
};

/// A stretch of a trajectory.
struct Stretch {
  Place back;               ///< its end that is earlier in time
  Place front;              ///< its end that is later in time
  Eigen::VectorXd z;        ///< the point drawn from it
  Eigen::VectorXd momenta;  ///< the sum of its momenta
  double log_density = never;
  double log_weight = never;
  bool ended = false;      ///< it turned or diverged within
  bool divergent = false;  ///< it diverged within
};

class NutsChain final : public MarkovChain {
 public:
  NutsChain(const LogDensity& density, const NutsOptions& options, const Eigen::MatrixXd& covariance, int warmup)
      : density_(density),
        options_(options),
        d_(Eigen::Index(density.dimension())),
        dense_(options.metric == "dense"),
        windows_(warmup_windows(warmup)),
        x_(d_),
        factor_(covariance_factor(covariance, density.dimension())),
        learnt_from_(Eigen::VectorXd::Zero(d_)),
        mean_(Eigen::VectorXd::Zero(d_)),
        squares_(Eigen::MatrixXd::Zero(d_, d_)) {
    expect(density.has_gradient(), "this sampler is run on a density with a gradient");
    if (!dense_) factor_ = covariance.diagonal().cwiseSqrt().asDiagonal();
  }

  void begin(std::span<const double> x, double log_density) override {
    expect(Eigen::Index(x.size()) == d_ && std::isfinite(log_density), "a chain begins where the density is positive");
    std::copy(x.begin(), x.end(), x_.data());
    log_density_ = log_density;
  }

  Transition step(RandomStream& random, bool learns) override {
    evaluations_ = 0;
    accepted_ = 0;
    tried_ = 0;
    if (learns && seeks_step_) seek_step(random);
    centre_ = x_;
    Place here = place_with_momentum(random);
    energy_ = 0.5 * here.p.squaredNorm() - here.log_density;
    Trajectory trajectory{.energy = energy_, .divergent = false, .depth = 0, .cut = true};
    Stretch all{.back = here, .front = here, .z = here.z, .momenta = here.p, .log_density = here.log_density, .log_weight = 0};
    for (; trajectory.depth < options_.depth; ++trajectory.depth) {
      const bool forward = random.uniform() < 0.5;
      const Stretch more = grow(forward ? all.front : all.back, trajectory.depth, forward ? step_ : -step_, random);
      trajectory.cut = !more.ended;
      trajectory.divergent = more.divergent;
      if (more.ended) break;
      if (log_uniform(random) < more.log_weight - all.log_weight) {
        all.z = more.z;
        all.log_density = more.log_density;
      }
      if (join(all, more, forward)) {
        trajectory.cut = false;
        ++trajectory.depth;
        break;
      }
    }
    x_ = centre_ + factor_ * all.z;
    log_density_ = all.log_density;
    const double acceptance = tried_ > 0 ? accepted_ / tried_ : 0;
    if (learns) learn(acceptance);
    return {.acceptance = acceptance, .evaluations = evaluations_, .trajectory = trajectory};
  }

  void freeze() override {
    if (averaged_ > 0) step_ = std::exp(log_step_mean_);
    frozen_ = true;
  }
  [[nodiscard]] std::span<const double> position(std::size_t /*walker*/) const override { return {x_.data(), std::size_t(d_)}; }
  [[nodiscard]] double log_density(std::size_t /*walker*/) const override { return log_density_; }

  [[nodiscard]] bool jumps() const override { return true; }
  void jump(std::size_t /*walker*/, std::span<const double> x, double log_density, const Eigen::VectorXd& centre) override {
    begin(x, log_density);
    learnt_from_ = centre;
  }

  void save(ByteWriter& out) const override {
    for (const double v : {log_density_, step_, log_step_mean_, error_mean_, anchor_, averaged_, counted_}) out.value(v);
    out.value(learned_);
    out.value(seeks_step_);
    out.value(frozen_);
    save_matrix(out, x_);
    save_matrix(out, learnt_from_);
    save_matrix(out, factor_);
    save_matrix(out, mean_);
    save_matrix(out, squares_);
  }
  void restore(ByteReader& in) override {
    for (double* v : {&log_density_, &step_, &log_step_mean_, &error_mean_, &anchor_, &averaged_, &counted_}) in.into(*v);
    in.into(learned_);
    in.into(seeks_step_);
    in.into(frozen_);
    restore_matrix(in, x_);
    restore_matrix(in, learnt_from_);
    restore_matrix(in, factor_);
    restore_matrix(in, mean_);
    restore_matrix(in, squares_);
  }

 private:
  static double log_uniform(RandomStream& random) { return std::log(std::max(random.uniform(), std::numeric_limits<double>::min())); }

  /// Computes density and gradient at z, which counts from centre_. An infinite gradient ends a trajectory as a density of zero does.
  void evaluate(Place& at) {
    const Eigen::VectorXd x = centre_ + factor_ * at.z;
    Eigen::VectorXd g(d_);
    at.log_density = density_.log_density_and_gradient({x.data(), std::size_t(d_)}, {g.data(), std::size_t(d_)});
    ++evaluations_;
    if (std::isnan(at.log_density) || at.log_density == -never)
      throw NumericsError(fmt::format("the log density is {} at {}", std::isnan(at.log_density) ? "NaN" : "infinite", place_text(density_, x)));
    if (at.log_density == never) return;
    if (g.array().isNaN().any()) throw NumericsError(fmt::format("the gradient of the log density is NaN at {}", place_text(density_, x)));
    at.gradient = factor_.transpose() * g;
    if (!at.gradient.allFinite()) at.log_density = never;
  }

  /// The chain's place with a new momentum.
  [[nodiscard]] Place place_with_momentum(RandomStream& random) {
    Place here{.z = Eigen::VectorXd::Zero(d_), .p = Eigen::VectorXd(d_), .gradient = {}};
    evaluate(here);
    if (here.log_density == never) throw NumericsError(fmt::format("the gradient of the log density is infinite at {}", place_text(density_, centre_)));
    for (double& p : here.p) p = random.normal();
    return here;
  }

  [[nodiscard]] Place leap(const Place& from, double step) {
    Place to{.z = from.z, .p = from.p + 0.5 * step * from.gradient, .gradient = {}};
    to.z += step * to.p;
    evaluate(to);
    if (to.log_density != never) to.p += 0.5 * step * to.gradient;
    return to;
  }

  /// The energy at the transition's beginning less that of a place; minus infinity where the density is zero.
  [[nodiscard]] double log_weight(const Place& at) const { return at.log_density == never ? never : at.log_density - 0.5 * at.p.squaredNorm() + energy_; }

  [[nodiscard]] Stretch grow(const Place& from, int depth, double step, RandomStream& random) {
    if (depth == 0) {
      const Place to = leap(from, step);
      const double weight = log_weight(to);
      const bool divergent = !(weight > -divergent_energy);
      tried_ += 1;
      accepted_ += std::min(1.0, std::exp(weight));
      return {
          .back = to, .front = to, .z = to.z, .momenta = to.p, .log_density = to.log_density, .log_weight = weight, .ended = divergent, .divergent = divergent};
    }
    Stretch near = grow(from, depth - 1, step, random);
    if (near.ended) return near;
    const bool forward = step > 0;
    const Stretch far = grow(forward ? near.front : near.back, depth - 1, step, random);
    if (far.ended) {
      near.ended = true;
      near.divergent = far.divergent;
      return near;
    }
    if (log_uniform(random) < far.log_weight - log_add(near.log_weight, far.log_weight)) {
      near.z = far.z;
      near.log_density = far.log_density;
    }
    near.ended = join(near, far, forward);
    return near;
  }

  /// Adds `more` at the earlier or the later end. Returns whether the whole turns back on itself, or one half with the next point of the other does.
  [[nodiscard]] static bool join(Stretch& all, const Stretch& more, bool forward) {
    const Stretch& earlier = forward ? all : more;
    const Stretch& later = forward ? more : all;
    const auto turns = [](const Eigen::VectorXd& momenta, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
      return momenta.dot(a) <= 0 || momenta.dot(b) <= 0;
    };
    const Eigen::VectorXd momenta = all.momenta + more.momenta;
    const bool turned = turns(momenta, earlier.back.p, later.front.p) || turns(earlier.momenta + later.back.p, earlier.back.p, later.back.p) ||
                        turns(later.momenta + earlier.front.p, earlier.front.p, later.front.p);
    all.log_weight = log_add(all.log_weight, more.log_weight);
    all.momenta = momenta;
    if (forward)
      all.front = more.front;
    else
      all.back = more.back;
    return turned;
  }

  /// Finds a step whose single leap is accepted about half the time. Dual averaging restarts towards ten times that step.
  void seek_step(RandomStream& random) {
    centre_ = x_;
    const Place here = place_with_momentum(random);
    energy_ = 0.5 * here.p.squaredNorm() - here.log_density;
    const auto accepted = [&] { return log_weight(leap(here, step_)) > std::log(0.5); };
    const bool up = accepted();
    for (int i = 0; i < 50 && accepted() == up; ++i) step_ *= up ? 2 : 0.5;
    anchor_ = std::log(10 * step_);
    log_step_mean_ = std::log(step_);
    error_mean_ = 0;
    averaged_ = 0;
    seeks_step_ = false;
  }

  void learn(double acceptance) {
    expect(!frozen_, "a frozen chain learns no more");
    ++learned_;
    averaged_ += 1;
    error_mean_ += (options_.target - acceptance - error_mean_) / (averaged_ + t0);
    const double log_step = anchor_ - std::sqrt(averaged_) / gamma_ * error_mean_;
    const double share = std::pow(averaged_, -kappa);
    log_step_mean_ = share * log_step + (1 - share) * log_step_mean_;
    step_ = std::exp(log_step);
    if (windows_.empty() || learned_ <= windows_.front() || learned_ > windows_.back()) return;
    counted_ += 1;
    const Eigen::VectorXd place = x_ - learnt_from_;
    const Eigen::VectorXd before = place - mean_;
    mean_ += before / counted_;
    squares_.noalias() += before * (place - mean_).transpose();
    if (!std::binary_search(windows_.begin() + 1, windows_.end(), learned_)) return;
    if (take_metric()) {
      step_ = std::exp(log_step_mean_);
      seeks_step_ = true;
    }
    mean_.setZero();
    squares_.setZero();
    counted_ = 0;
  }

  /// Takes the metric from the window's draws. Returns false and leaves the metric unchanged where a coordinate has not moved.
  bool take_metric() {
    const Eigen::MatrixXd covariance = squares_ / std::max(1.0, counted_ - 1);
    const Eigen::VectorXd variances = covariance.diagonal();
    if (!(variances.minCoeff() > 0) || !covariance.allFinite()) return false;
    if (!dense_) {
      factor_ = variances.cwiseSqrt().asDiagonal();
      return true;
    }
    Eigen::MatrixXd shrunk = counted_ / (counted_ + shrinkage + double(d_)) * covariance;
    shrunk.diagonal() = variances;
    const Cholesky cholesky(0.5 * (shrunk + shrunk.transpose()));
    if (!cholesky.positive_definite() || !cholesky.lower().allFinite()) return false;
    factor_ = cholesky.lower();
    return true;
  }

  const LogDensity& density_;
  NutsOptions options_;
  Eigen::Index d_;
  bool dense_;
  std::vector<int> windows_;
  Eigen::VectorXd x_;
  Eigen::VectorXd centre_;  ///< the place at which the transition began
  double log_density_ = 0;
  Eigen::MatrixXd factor_;  ///< L
  // The state of dual averaging.
  double step_ = 0.5;
  double log_step_mean_ = std::log(0.5);
  double error_mean_ = 0;
  double anchor_ = std::log(5.0);
  double averaged_ = 0;
  bool seeks_step_ = true;
  int learned_ = 0;              ///< transitions of the warm-up so far
  double counted_ = 0;           ///< draws of the window so far
  Eigen::VectorXd learnt_from_;  ///< the point about which the window's moments are taken
  Eigen::VectorXd mean_;         ///< mean of the window's draws
  Eigen::MatrixXd squares_;      ///< their sums of squares
  bool frozen_ = false;
  // The next four are those of one transition.
  double energy_ = 0;    ///< at its beginning
  double accepted_ = 0;  ///< sum of the acceptance probabilities of its leaps
  double tried_ = 0;     ///< number of its leaps
  int evaluations_ = 0;
};

}  // namespace

std::vector<int> warmup_windows(int warmup) {
  if (warmup < 20) return {};
  int first = 75;
  int window = 25;
  int last = 50;
  if (first + window + last > warmup) {
    first = 15 * warmup / 100;
    last = warmup / 10;
    window = warmup - first - last;
  }
  std::vector<int> ends{first};
  for (int at = first, end = warmup - last; at < end; window *= 2) {
    at += window;
    if (at + 2 * window > end) at = end;
    ends.push_back(at);
  }
  return ends;
}

std::unique_ptr<MarkovChain> nuts_chain(const LogDensity& density, const NutsOptions& options, const Eigen::MatrixXd& covariance, int warmup) {
  return std::make_unique<NutsChain>(density, options, covariance, warmup);
}

SamplerEntry nuts_sampler() {
  constexpr double usual = 7;  // steps of a trajectory
  return {.chain = [](const ChainSetting& s) { return nuts_chain(s.density, s.options.table<NutsOptions>(), s.mode.covariance, s.options.warmup); },
          .evaluations = [](const SamplerOptions&, std::size_t) { return usual; },
          .lengths = {.warmup = 1000, .draws = 2000, .thin = 1},
          .options = NutsOptions{},
          .needs_gradient = true,
          .remedies = {.accuracy_key = "sampler.nuts.target", .safer_accuracy = 0.95, .length_key = "sampler.nuts.depth"}};
}

}  // namespace calomel
