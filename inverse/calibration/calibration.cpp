#include "inverse/calibration/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/not_finite.hpp"

namespace calomel {

double distance(const Proposal& a, const Proposal& b, const Bounds& bounds) {
  double d = 0;
  for (std::size_t k = 0; k < a.theta.size(); ++k)
    d = std::max(d, std::abs(a.theta[k] - b.theta[k]) / (bounds.high[Eigen::Index(k)] - bounds.low[Eigen::Index(k)]));
  return d;
}

Bounds bounds_of(const ModelShape& shape) {
  const auto n = Eigen::Index(shape.parameters.size());
  Bounds bounds{Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (Eigen::Index k = 0; k < n; ++k) bounds.low[k] = shape.parameters[std::size_t(k)].min, bounds.high[k] = shape.parameters[std::size_t(k)].max;
  return bounds;
}

std::vector<Proposal> spread_out(const std::vector<Proposal>& pool, std::size_t n, double separation, const Bounds& bounds) {
  std::vector<Proposal> out;
  for (const auto& p : pool) {
    if (out.size() == n) break;
    if (std::all_of(out.begin(), out.end(), [&](const auto& q) {
          const double d = distance(p, q, bounds);
          return d > 0 && d >= separation;
        }))
      out.push_back(p);
  }
  return out;
}

std::vector<Proposal> well_separated(std::vector<Proposal> pool, std::size_t n, double separation, const Bounds& bounds) {
  std::stable_sort(pool.begin(), pool.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
  return spread_out(pool, n, separation, bounds);
}

Calibration begin_calibration(const Problem& problem, Objective objective) {
  Calibration out;
  out.objective = std::move(objective);
  out.nominal = nominal(problem.shape);
  out.warnings = problem.warnings;
  return out;
}

void decide_by_true_model(Calibration& out, const Problem& problem, const ForwardModel& true_model, std::span<const Proposal> ranked, std::size_t wanted,
                          double cost_at_nominal, int threads, const CalibrationProgress& progress) {
  // 1. The best distinct points and the nominal one in the true model.
  const Clock clock;
  const auto& parameters = problem.shape.parameters;
  const auto judged = [&](std::span<const double> theta, Prediction p, std::vector<double>& values) {
    Candidate c{.theta = {theta.begin(), theta.end()}};
    if (p.ok) c.score = score(problem, p.mean);
    if (p.ok && c.score.ok) {
      c.objective_model = out.objective.value(c.score);
      values = std::move(p.mean);
    } else {
      c.message = p.ok ? "the history holds a NaN" : p.message;
    }
    if (c.objective_model && !std::isfinite(*c.objective_model)) {
      c.objective_model.reset();
      c.message = "the objective has no finite value there";
    }
    return c;
  };
  std::vector<Candidate> tried;
  std::vector<std::vector<double>> histories;
  std::size_t succeeded = 0;
  bool nominal_is_due = true;
  for (std::size_t next = 0; nominal_is_due || (succeeded < wanted && next < ranked.size());) {
    const std::size_t batch = std::min(wanted - succeeded, ranked.size() - next);
    const std::size_t before = tried.size();
    Eigen::MatrixXd thetas(Eigen::Index(parameters.size()), Eigen::Index(batch + nominal_is_due));
    for (std::size_t i = 0; i < batch; ++i) thetas.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXd>(ranked[next + i].theta.data(), thetas.rows());
    if (nominal_is_due) thetas.rightCols(1) = Eigen::Map<const Eigen::VectorXd>(out.nominal.data(), thetas.rows());
    auto predictions = true_model.predictions(thetas, threads, [&](std::size_t done, std::size_t total) {
      if (progress) progress("true-model runs", before + done, before + total);
    });
    for (std::size_t i = 0; i < batch; ++i) {
      histories.emplace_back();
      tried.push_back(judged(ranked[next + i].theta, std::move(predictions[i]), histories.back()));
      tried.back().objective_surrogate = out.objective.cost(ranked[next + i].cost);
      succeeded += tried.back().objective_model.has_value();
    }
    if (nominal_is_due) out.at_nominal = judged(out.nominal, std::move(predictions.back()), out.nominal_values);
    next += batch;
    nominal_is_due = false;
  }
  out.at_nominal.objective_surrogate = std::isfinite(cost_at_nominal) ? out.objective.cost(cost_at_nominal) : nan;
  out.model_runs = tried.size() + 1;
  out.model_s += clock.seconds();

  // 2. The best by the true model wins.
  std::vector<std::size_t> order(tried.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto cost = [&](const Candidate& c) { return c.objective_model ? out.objective.cost(*c.objective_model) : std::numeric_limits<double>::infinity(); };
  std::stable_sort(order.begin(), order.end(), [&](auto i, auto j) { return cost(tried[i]) < cost(tried[j]); });
  for (const auto i : order) (succeeded > 0 && !tried[i].objective_model ? out.failed : out.candidates).push_back(tried[i]);
  if (succeeded > 0) {
    out.status = CalibrationStatus::done;
    out.best = out.candidates[0];
    out.calibrated = histories[order[0]];
  }
  if (out.at_nominal.objective_model && cost(out.at_nominal) <= cost(out.best)) {
    const bool any = out.status == CalibrationStatus::done;
    if (any)
      out.warnings.push_back(
          fmt::format("no candidate is better than the nominal parameters in the true model ({:.4g} against {:.4g}): the nominal ones are kept; the "
                      "surrogate is too coarse near its optimum",
                      *out.best.objective_model, *out.at_nominal.objective_model));
    out.best = out.at_nominal;
    out.calibrated = out.nominal_values;
  }
  if (succeeded == 0) {
    out.status = CalibrationStatus::no_candidate;
    out.message = ranked.empty() ? "the surrogate failed at every point" : "the true model failed at every candidate: " + tried[0].message;
    if (!out.at_nominal.objective_model) {
      out.best = tried.empty() ? out.at_nominal : tried[0];
      out.message += "; the result is the surrogate's alone";
    } else {
      out.message += "; the nominal parameters are kept";
    }
    out.warnings.push_back(out.message);
  } else if (out.best.theta == out.at_nominal.theta) {
    out.message = fmt::format("{} = {:.6g} in the true model at the nominal parameters: none of {} candidates is better", out.objective.name,
                              *out.best.objective_model, succeeded);
  } else {
    out.message = fmt::format("{} = {:.6g} in the true model at the best of {} candidates", out.objective.name, *out.best.objective_model, succeeded);
  }
  out.theta = out.best.theta;

  // 3. What the reader should know.
  if (!out.failed.empty())
    out.warnings.push_back(fmt::format("the true model failed at {} candidates, others took their place: {}", out.failed.size(), out.failed[0].message));
  if (succeeded > 0 && succeeded < wanted) out.warnings.push_back(fmt::format("{} of {} candidates: no more distinct points could be run", succeeded, wanted));
  if (!out.at_nominal.objective_model) out.warnings.push_back("the true model failed at the nominal parameters: " + out.at_nominal.message);
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const double share = (out.theta[k] - parameters[k].min) / (parameters[k].max - parameters[k].min);
    if (share < 1e-3 || share > 1 - 1e-3)
      out.warnings.push_back(fmt::format("{} = {} lies on its {} bound: its best value is beyond the bound, or the data do not determine it",
                                         parameters[k].name, fmt::format("{:.6g}", out.theta[k]), share < 0.5 ? "lower" : "upper"));
  }
}

}  // namespace calomel
