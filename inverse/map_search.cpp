#include "inverse/map_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/linear_algebra.hpp"
#include "base/parallel.hpp"
#include "forward/campaign/design.hpp"

namespace calomel {

namespace {

/// Starts: the best distinct points of a design.
std::vector<Eigen::VectorXd> choose_starts(const Eigen::MatrixXd& thetas, const Eigen::VectorXd& log_posterior, const SearchSpace& space, std::size_t wanted,
                                           const Bounds& bounds) {
  std::vector<Proposal> pool;
  for (Eigen::Index i = 0; i < thetas.cols(); ++i)
    if (std::isfinite(log_posterior[i])) pool.push_back({-log_posterior[i], {thetas.col(i).data(), thetas.col(i).data() + thetas.rows()}});
  std::vector<Eigen::VectorXd> starts;
  for (const auto& p : well_separated(std::move(pool), wanted, 0.05, bounds)) starts.push_back(space.from(p.theta));
  return starts;
}

}  // namespace

std::vector<Proposal> proposals(const std::vector<Optimum>& optima, const SearchSpace& space) {
  std::vector<Proposal> all;
  for (const auto& o : optima) all.push_back({-o.log_posterior, space.theta(o.x)});
  return all;
}

Likelihood MapSearch::likelihood(std::span<const double> theta, bool with_surrogate) const {
  return likelihood_at(problem_, recordings_, recording_options_, options_.likelihood, options_.discrepancy.distance, models_, theta, with_surrogate);
}

Eigen::MatrixXd MapSearch::design(std::uint64_t seed) const {
  const Eigen::Index n = space_.size();
  const auto count = std::size_t(on_surrogate() ? options_.design : std::min(options_.design, 16 * int(n)));
  const Eigen::MatrixXd u = sobol_points(std::size_t(n), count, seed);
  Eigen::MatrixXd thetas(n, Eigen::Index(count) + 1);
  for (Eigen::Index i = 0; i < Eigen::Index(count); ++i) {
    Eigen::VectorXd x(n);
    for (Eigen::Index k = 0; k < n; ++k) x[k] = space_.low()[k] + u(k, i) * (space_.high()[k] - space_.low()[k]);
    auto t = space_.theta(x);
    for (Eigen::Index k = 0; k < n; ++k) {
      const Prior& prior = space_.priors()[std::size_t(k)];
      if (prior.kind() != "uniform")
        t[std::size_t(k)] = std::clamp(prior.quantile(std::clamp(u(k, i), 1e-3, 1 - 1e-3)), space_.parameters()[std::size_t(k)].min,
                                       space_.parameters()[std::size_t(k)].max);
    }
    thetas.col(i) = Eigen::Map<const Eigen::VectorXd>(t.data(), n);
  }
  const auto nominal_point = nominal(problem_.shape);
  thetas.col(Eigen::Index(count)) = Eigen::Map<const Eigen::VectorXd>(nominal_point.data(), n);
  return thetas;
}

Eigen::VectorXd MapSearch::scan(const Likelihood& likelihood, const Eigen::MatrixXd& design) {
  const PosteriorMode mode(model(), likelihood, space_, threads_);
  Eigen::VectorXd l = mode.log_posteriors(design);
  evaluations_ += mode.evaluations();
  return l;
}

std::vector<Optimum> MapSearch::optima(const Likelihood& likelihood, const std::vector<Eigen::VectorXd>& starts, const std::vector<Eigen::VectorXd>& half_widths,
                                       const CalibrationProgress& progress) {
  std::vector<std::optional<Optimum>> found(starts.size());
  std::mutex lock;
  std::size_t done = 0;
  const PosteriorMode mode(model(), likelihood, space_, on_surrogate() ? 1 : threads_);
  parallel_for(starts.size(), on_surrogate() ? threads_ : 1, [&](std::size_t i) {
    Eigen::VectorXd widths = half_widths[i];
    auto m = mode.find(starts[i], widths);
    for (int pass = 0; m && pass < 2; ++pass) {  // secants of the posterior's own width, from where the first ones led
      const auto l = mode.linearise(m->x, Eigen::MatrixXd(widths.asDiagonal()));
      if (!l) break;
      bool limited = false;
      const Eigen::MatrixXd c = covariance_of(mode.curvature(*l), space_, m->x, limited);
      found[i] = Optimum{m->x, m->log_posterior, c};
      widths = space_.secant_widths(m->x, secant() * c.diagonal().cwiseSqrt(), on_surrogate() ? 0.3 : options_.secant);
      if (pass == 0) {
        const auto again = mode.find(m->x, widths);
        if (again && again->log_posterior >= m->log_posterior) m = again;
      }
    }
    const std::lock_guard guard(lock);
    if (progress) progress("searches", ++done, starts.size());
  });
  evaluations_ += mode.evaluations();
  std::vector<Optimum> all;
  for (auto& f : found)
    if (f) all.push_back(std::move(*f));
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.log_posterior > b.log_posterior; });
  return all;
}

std::vector<Optimum> MapSearch::global(std::optional<Likelihood>& likelihood, const Eigen::MatrixXd& design, const std::vector<Eigen::VectorXd>& also,
                                       const CalibrationProgress& progress) {
  const Bounds bounds = bounds_of(problem_.shape);
  const Eigen::VectorXd box = space_.high() - space_.low();
  std::vector<Eigen::VectorXd> starts = choose_starts(design, scan(*likelihood, design), space_, std::size_t(options_.starts), bounds);
  starts.insert(starts.end(), also.begin(), also.end());
  std::vector<Optimum> found = optima(*likelihood, starts, std::vector<Eigen::VectorXd>(starts.size(), 0.02 * box), progress);
  if (found.empty()) return found;
  likelihood.emplace(this->likelihood(space_.theta(found[0].x), true));
  std::vector<Eigen::VectorXd> from, widths;
  for (const auto& p : well_separated(proposals(found, space_), std::size_t(options_.candidates), options_.separation, bounds)) {
    from.push_back(space_.from(p.theta));
    for (const auto& o : found)
      if (space_.theta(o.x) == p.theta && widths.size() < from.size())
        widths.push_back(space_.secant_widths(o.x, secant() * o.covariance.diagonal().cwiseSqrt(), secant()));
  }
  if (auto again = optima(*likelihood, from, widths, progress); !again.empty()) found = std::move(again);
  return found;
}

double laplace_log_evidence(const Optimum& o, const SearchSpace& space) {
  const Eigen::VectorXd m = space.mode_slope(o.x);
  const Eigen::MatrixXd c = m.asDiagonal() * o.covariance * m.asDiagonal();
  return o.log_posterior + 0.5 * double(o.x.size()) * std::log(2 * std::numbers::pi) + Cholesky(c).half_log_determinant();
}

}  // namespace calomel
