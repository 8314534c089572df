#include "inverse/rival_hypothesis.hpp"

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.hpp"
#include "base/random.hpp"
#include "inverse/polish.hpp"

namespace calomel {

namespace {

constexpr std::size_t starts = 2;
constexpr double first_width = 0.02;  ///< of the box, before a covariance is known
constexpr std::uint64_t rival_stream = 90210;

std::vector<Parameter> chosen(const std::vector<Parameter>& parameters, const std::vector<std::size_t>& free) {
  std::vector<Parameter> out;
  for (const auto k : free) out.push_back(parameters[k]);
  return out;
}

}  // namespace

std::vector<double> RunStore::history(std::span<const double> theta) {
  const std::vector<double> key(theta.begin(), theta.end());
  {
    const std::lock_guard guard(lock_);
    if (const auto at = runs_.find(key); at != runs_.end()) return at->second;
  }
  Prediction p = model_.evaluate(theta);
  const std::lock_guard guard(lock_);
  ++made_;
  return runs_[key] = p.ok ? std::move(p.mean) : std::vector<double>{};
}

void RunStore::put(const std::vector<double>& theta, std::vector<double> history) {
  const std::lock_guard guard(lock_);
  runs_.emplace(theta, std::move(history));
}

HypothesisModel::HypothesisModel(RunStore& store, const MeshError& mesh, std::vector<double> held, std::vector<std::size_t> free)
    : store_(store), mesh_(mesh), held_(std::move(held)), free_(std::move(free)), shape_(store.model().shape()) {
  shape_.parameters = chosen(shape_.parameters, free_);
}

std::vector<double> HypothesisModel::full(std::span<const double> theta) const {
  std::vector<double> all = held_;
  for (std::size_t k = 0; k < free_.size(); ++k) all[free_[k]] = theta[k];
  return all;
}

std::vector<double> HypothesisModel::reduced(std::span<const double> all) const {
  std::vector<double> theta;
  for (const auto k : free_) theta.push_back(all[k]);
  return theta;
}

bool HypothesisModel::holds(std::span<const double> all) const {
  const auto same = full(reduced(all));
  return std::equal(same.begin(), same.end(), all.begin());
}

std::vector<double> HypothesisModel::shifted(std::span<const double> all, std::vector<double> history) const {
  if (!mesh_.empty() && !history.empty()) Eigen::Map<Eigen::VectorXd>(history.data(), Eigen::Index(history.size())) += mesh_.shift(all);
  return history;
}

Prediction HypothesisModel::evaluate(std::span<const double> theta) const {
  const auto all = full(theta);
  Prediction p{.mean = shifted(all, store_.history(all))};
  p.ok = !p.mean.empty();
  return p;
}

Hypothesis::Hypothesis(RunStore& store, const MeshError& mesh, const std::vector<Parameter>& parameters, std::vector<double> held, std::vector<std::size_t> free)
    : store_(store), model_(store, mesh, std::move(held), free), space_(chosen(parameters, free)) {}

void Hypothesis::try_at(const std::vector<double>& all) { store_.history(model_.full(space_.theta(space_.from(model_.reduced(all))))); }

std::vector<PosteriorPoint> Hypothesis::best_known(const Likelihood& likelihood, std::size_t wanted) const {
  std::vector<PosteriorPoint> known;
  for (const auto& [all, history] : store_.all()) {
    if (history.empty() || !model_.holds(all)) continue;
    PosteriorPoint p{.theta = model_.reduced(all)};
    p.history = model_.shifted(all, history);
    p.log_posterior = likelihood.log_likelihood(p.theta, p.history) + space_.log_prior(p.theta);
    if (std::isfinite(p.log_posterior)) known.push_back(std::move(p));
  }
  std::stable_sort(known.begin(), known.end(), [](const auto& a, const auto& b) { return a.log_posterior > b.log_posterior; });
  if (known.size() > wanted) known.resize(wanted);
  return known;
}

JudgedPoint Hypothesis::judge(const Likelihood& likelihood, const JudgeSettings& settings, const CalibrationProgress& progress) {
  const PosteriorMode mode(model_, likelihood, space_, settings.threads);
  const auto from = best_known(likelihood, starts);
  if (from.empty()) throw NumericsError("no run of the model belongs to this hypothesis");
  const Eigen::VectorXd box = space_.high() - space_.low();
  bool limited = false;
  if (widths_.size() == 0) {
    const Eigen::VectorXd x = space_.from(from[0].theta);
    const auto at = mode.linearise(x, Eigen::MatrixXd(space_.secant_widths(x, first_width * box, settings.secant).asDiagonal()));
    if (!at) throw NumericsError("the model fails all about the best run of a hypothesis");
    widths_ = space_.secant_widths(x, settings.secant * covariance_of(mode.curvature(*at), space_, x, limited).diagonal().cwiseSqrt(), settings.secant);
  }
  PosteriorPoint best = from[0];
  const auto polish_from = [&](const PosteriorPoint& start) {
    const Eigen::MatrixXd guess = widths_.cwiseAbs2().asDiagonal();
    const Polished p = polish(mode, space_, start, guess, widths_, settings.polish_runs, [&](int done) {
      if (progress) progress("runs of rivals", std::size_t(done), std::size_t(settings.polish_runs));
    });
    if (p.point.log_posterior > best.log_posterior) best = p.point;
  };
  for (const auto& start : from) polish_from(start);
  if (const auto seen = best_known(likelihood, 1); seen[0].log_posterior > best.log_posterior) best = seen[0];  // a point of the secants
  const Eigen::VectorXd x = space_.from(best.theta);
  const auto at = mode.linearise(x, Eigen::MatrixXd(widths_.asDiagonal()));
  if (!at) throw NumericsError("the model fails beside the best run of a hypothesis");
  const Eigen::MatrixXd covariance = covariance_of(mode.curvature(*at), space_, x, limited);
  JudgedPoint out;
  const Eigen::VectorXd residual = likelihood.residual(best.theta, best.history);
  out.fit = {.theta = model_.full(best.theta), .log_likelihood = likelihood.errors().log_density(residual), .log_posterior = best.log_posterior};
  out.fit.chi2 = likelihood.errors().chi2(residual);
  out.roughness = roughness_of(*at, likelihood, space_);
  out.fit.log_evidence = laplace_log_evidence({x, best.log_posterior, covariance}, space_) + std::log(share_within(space_, x, covariance, settings.seed));
  return out;
}

double roughness_of(const Linearisation& at, const Likelihood& likelihood, const SearchSpace& space) {
  const double middle = likelihood.errors().log_density_at(at.chi2) + space.log_prior(space.theta(at.x));
  double squares = 0, weights = 0;
  for (Eigen::Index i = 0; i < at.points.cols(); ++i) {
    const Eigen::VectorXd step = at.points.col(i) - at.x;
    if (step.cwiseAbs().maxCoeff() == 0 || !std::isfinite(at.log_posteriors[i])) continue;
    const double foretold = likelihood.errors().log_density_at((at.residual + at.jacobian * step).squaredNorm()) + space.log_prior(space.theta(at.points.col(i)));
    const double weight = 1 / (1 + std::pow(middle - foretold, 2));
    squares += weight * std::pow(at.log_posteriors[i] - foretold, 2), weights += weight;
  }
  return weights > 0 ? std::sqrt(squares / weights / 1.5) : 0;
}

double share_within(const SearchSpace& space, const Eigen::VectorXd& x, const Eigen::MatrixXd& covariance, std::uint64_t seed) {
  constexpr int draws = 4000;
  RandomStream random(seed, rival_stream);
  const Eigen::MatrixXd root = Cholesky(covariance).lower();
  int within = 0;
  for (int i = 0; i < draws; ++i) {
    Eigen::VectorXd z(x.size());
    for (auto& value : z) value = random.normal();
    const Eigen::VectorXd at = x + root * z;
    within += ((at - space.low()).array() >= 0).all() && ((space.high() - at).array() >= 0).all();
  }
  return std::max(within, 1) / double(draws);
}

}  // namespace calomel
