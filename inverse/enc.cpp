#include "inverse/enc.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>

#include "base/parallel.hpp"
#include "base/random.hpp"

namespace calomel {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct Point {
  double cost;
  std::vector<double> theta;
};

/// The best point of every cell of a coarse grid that a round has visited: what candidates are chosen from, so that they can lie apart
/// even when every round ends in the same optimum.
class Visited {
 public:
  Visited(const Bounds& bounds, double cell) : bounds_(bounds), cell_(std::max(cell, 1e-3)) {}
  void add(const Eigen::MatrixXd& points, std::span<const double> costs) {
    std::vector<int> key(std::size_t(points.rows()));
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const double cost = costs[std::size_t(i)];
      if (!std::isfinite(cost)) continue;
      for (Eigen::Index k = 0; k < points.rows(); ++k) key[std::size_t(k)] = int((points(k, i) - bounds_.low[k]) / (bounds_.high[k] - bounds_.low[k]) / cell_);
      const auto [it, fresh] = cells_.try_emplace(key);
      if (fresh || cost < it->second.cost) it->second = {cost, {points.col(i).data(), points.col(i).data() + points.rows()}};
    }
  }
  /// The best `n` of them, best first.
  [[nodiscard]] std::vector<Point> best(std::size_t n) const {
    std::vector<Point> all;
    for (const auto& [key, point] : cells_) all.push_back(point);
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
    if (all.size() > n) all.resize(n);
    return all;
  }

 private:
  const Bounds& bounds_;
  double cell_;
  std::map<std::vector<int>, Point> cells_;
};

/// Largest distance over the parameters, in units of their bounds.
double distance(const Point& a, const Point& b, const Bounds& bounds) {
  double d = 0;
  for (std::size_t k = 0; k < a.theta.size(); ++k)
    d = std::max(d, std::abs(a.theta[k] - b.theta[k]) / (bounds.high[Eigen::Index(k)] - bounds.low[Eigen::Index(k)]));
  return d;
}

/// Points in order of cost, each at least `separation` from those before it.
std::vector<Point> well_separated(std::vector<Point> pool, std::size_t n, double separation, const Bounds& bounds) {
  std::stable_sort(pool.begin(), pool.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
  std::vector<Point> out;
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

class Clock {
 public:
  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::vector<EncOptimizer> by_optimizer(const EncSummary& summary, const std::vector<std::string>& names) {
  std::vector<EncOptimizer> all;
  for (const auto& name : names) {
    EncOptimizer o{name};
    double sum = 0, squares = 0, best = std::numeric_limits<double>::infinity();
    for (const auto& r : summary.rounds) {
      if (r.optimizer != name || !std::isfinite(r.objective)) continue;
      ++o.rounds, sum += r.objective;
      if (const double c = summary.objective.cost(r.objective); c < best) best = c, o.best = r.objective, o.trace = r.trace;
    }
    if (o.rounds == 0) {
      o.mean = o.sd = o.best = nan;
    } else {
      o.mean = sum / o.rounds;
      for (const auto& r : summary.rounds)
        if (r.optimizer == name && std::isfinite(r.objective)) squares += (r.objective - o.mean) * (r.objective - o.mean);
      o.sd = o.rounds > 1 ? std::sqrt(squares / (o.rounds - 1)) : nan;
    }
    all.push_back(std::move(o));
  }
  return all;
}

}  // namespace

EncSummary run_enc(const Problem& problem, const ForwardModel& surrogate, const ForwardModel& true_model, const EncOptions& options, std::uint64_t seed,
                   int threads, const EncProgress& progress) {
  const auto& parameters = problem.shape.parameters;
  expect(surrogate.shape().values() == problem.shape.values() && true_model.shape().values() == problem.shape.values(),
         "surrogate, true model and problem have one shape");
  expect(!parameters.empty() && surrogate.shape().parameters.size() == parameters.size(), "there are parameters to calibrate");
  EncSummary out;
  out.objective = objectives().get(options.objective, "enc.objective");
  for (const auto& name : options.optimizers) (void)optimizers().get(name, "enc.optimizers");
  if (options.optimizers.empty()) throw InputError({.problem = "no optimiser is listed", .key = "enc.optimizers", .range = join(optimizers().names())});
  out.nominal = nominal(problem.shape);
  out.warnings = problem.warnings;
  Bounds bounds{Eigen::VectorXd(parameters.size()), Eigen::VectorXd(parameters.size())};
  for (std::size_t k = 0; k < parameters.size(); ++k) bounds.low[Eigen::Index(k)] = parameters[k].min, bounds.high[Eigen::Index(k)] = parameters[k].max;

  // 1. The rounds, each with its own random stream.
  const Clock search;
  const std::size_t rounds = std::size_t(options.rounds);
  const std::size_t wanted = std::size_t(options.candidates);
  out.rounds.resize(rounds);
  std::vector<std::vector<Point>> pools(rounds);
  std::mutex lock;
  std::size_t finished = 0;
  const auto report = [&](const char* what, std::size_t total) {
    const std::lock_guard guard(lock);
    ++finished;
    if (progress) progress(what, finished, total);
  };
  parallel_for(rounds, threads, [&](std::size_t round) {
    RandomStream draw(seed, round);
    const std::string& name = options.optimizers[draw.below(options.optimizers.size())];
    Visited visited(bounds, options.separation);
    const BatchFunction function = [&](const Eigen::MatrixXd& points, std::span<double> values) {
      const auto costs = out.objective.costs(problem, surrogate.means(points, 1));
      std::copy(costs.begin(), costs.end(), values.begin());
      visited.add(points, values);
    };
    const auto result = minimise(optimizers().get(name), function, bounds, {options.generations, options.population}, draw(), round);
    EncRound& r = out.rounds[round];
    r.optimizer = name;
    r.theta.assign(result.x.begin(), result.x.end());
    const auto published = [&](double cost) { return std::isfinite(cost) ? out.objective.cost(cost) : nan; };
    r.objective = published(result.f);
    for (const double f : result.trace) r.trace.push_back(published(f));
    r.evaluations = result.evaluations;
    pools[round] = visited.best(20 * wanted);
    report("rounds", rounds);
  });
  for (const auto& r : out.rounds) out.evaluations += r.evaluations;
  out.optimizers = by_optimizer(out, options.optimizers);
  out.search_s = search.seconds();

  // 2. The best distinct points and the nominal one in the true model.
  const Clock model;
  std::vector<Point> pool;
  for (auto& p : pools) pool.insert(pool.end(), p.begin(), p.end());
  const std::vector<Point> ranked = well_separated(std::move(pool), 3 * wanted, options.separation, bounds);
  const auto run = [&](std::span<const double> theta, std::vector<double>& values) {
    EncCandidate c{.theta = {theta.begin(), theta.end()}};
    Prediction p = true_model.evaluate(theta);
    if (p.ok) c.score = score(problem, p.mean);
    if (p.ok && c.score.ok)
      c.objective_model = out.objective.value(c.score), values = std::move(p.mean);
    else
      c.message = p.ok ? "the history holds a NaN" : p.message;
    return c;
  };
  std::vector<EncCandidate> tried;
  std::vector<std::vector<double>> histories;
  finished = 0;
  std::size_t succeeded = 0;
  for (std::size_t next = 0, first = 1; first || (succeeded < wanted && next < ranked.size());) {
    const std::size_t batch = std::min(wanted - succeeded, ranked.size() - next);
    const std::size_t at = tried.size();
    tried.resize(at + batch), histories.resize(at + batch);
    parallel_for(batch + first, threads, [&](std::size_t i) {
      if (i == batch) {
        out.at_nominal = run(out.nominal, out.nominal_values);
      } else {
        tried[at + i] = run(ranked[next + i].theta, histories[at + i]);
        tried[at + i].objective_surrogate = out.objective.cost(ranked[next + i].cost);
      }
      report("true-model runs", at + batch + 1);
    });
    for (std::size_t i = at; i < tried.size(); ++i) succeeded += tried[i].objective_model.has_value();
    next += batch, first = 0;
  }
  {
    const Eigen::MatrixXd theta = Eigen::Map<const Eigen::VectorXd>(out.nominal.data(), Eigen::Index(out.nominal.size()));
    const double cost = out.objective.costs(problem, surrogate.means(theta, 1))[0];
    out.at_nominal.objective_surrogate = std::isfinite(cost) ? out.objective.cost(cost) : nan;
  }
  out.model_runs = tried.size() + 1;
  out.model_s = model.seconds();

  // 3. The best by the true model wins.
  std::vector<std::size_t> order(tried.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto cost = [&](const EncCandidate& c) { return c.objective_model ? out.objective.cost(*c.objective_model) : std::numeric_limits<double>::infinity(); };
  std::stable_sort(order.begin(), order.end(), [&](auto i, auto j) { return cost(tried[i]) < cost(tried[j]); });
  for (const auto i : order) (succeeded > 0 && !tried[i].objective_model ? out.failed : out.candidates).push_back(tried[i]);
  if (succeeded > 0) {
    out.status = EncStatus::done;
    out.best = out.candidates[0], out.calibrated = histories[order[0]];
  }
  if (out.at_nominal.objective_model && cost(out.at_nominal) <= cost(out.best)) {
    const bool any = out.status == EncStatus::done;
    if (any)
      out.warnings.push_back(
          fmt::format("no candidate is better than the nominal parameters in the true model ({:.4g} against {:.4g}): the nominal ones are kept; the "
                      "surrogate is too coarse near its optimum",
                      *out.best.objective_model, *out.at_nominal.objective_model));
    out.best = out.at_nominal, out.calibrated = out.nominal_values;
  }
  if (succeeded == 0) {
    out.status = EncStatus::no_candidate;
    out.message = ranked.empty() ? "the surrogate failed at every point" : "the true model failed at every candidate: " + tried[0].message;
    if (!out.at_nominal.objective_model) {
      out.best = tried.empty() ? out.at_nominal : tried[0];
      out.message += "; the result is the surrogate's alone";
    } else {
      out.message += "; the nominal parameters are kept";
    }
    out.warnings.push_back(out.message);
  } else {
    out.message = fmt::format("{} = {:.6g} in the true model at the best of {} candidates", out.objective.name, *out.best.objective_model, succeeded);
  }
  out.theta = out.best.theta;

  // 4. What the reader should know.
  if (!out.failed.empty())
    out.warnings.push_back(fmt::format("the true model failed at {} candidates, others took their place: {}", out.failed.size(), out.failed[0].message));
  if (succeeded > 0 && succeeded < wanted) out.warnings.push_back(fmt::format("{} of {} candidates: no more distinct points could be run", succeeded, wanted));
  if (!out.at_nominal.objective_model) out.warnings.push_back("the true model failed at the nominal parameters: " + out.at_nominal.message);
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const double share = (out.theta[k] - parameters[k].min) / (parameters[k].max - parameters[k].min);
    if (share < 1e-3 || share > 1 - 1e-3)
      out.warnings.push_back(fmt::format("{} = {} sits on its {} bound: the data would have it outside, or do not determine it", parameters[k].name,
                                         fmt::format("{:.6g}", out.theta[k]), share < 0.5 ? "lower" : "upper"));
  }
  return out;
}

}  // namespace calomel
