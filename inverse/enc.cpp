#include "inverse/enc.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>

#include "base/parallel.hpp"
#include "base/random.hpp"

namespace calomel {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

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
  [[nodiscard]] std::vector<Proposal> best(std::size_t n) const {
    std::vector<Proposal> all;
    for (const auto& [key, point] : cells_) all.push_back(point);
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
    if (all.size() > n) all.resize(n);
    return all;
  }

 private:
  const Bounds& bounds_;
  double cell_;
  std::map<std::vector<int>, Proposal> cells_;
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
                   int threads, const CalibrationProgress& progress) {
  const auto& parameters = problem.shape.parameters;
  expect(surrogate.shape().values() == problem.shape.values() && true_model.shape().values() == problem.shape.values(),
         "surrogate, true model and problem have one shape");
  expect(!parameters.empty() && surrogate.shape().parameters.size() == parameters.size(), "there are parameters to calibrate");
  EncSummary out{begin_calibration(problem, options.objective, "enc.objective")};
  for (const auto& name : options.optimizers) (void)optimizers().get(name, "enc.optimizers");
  if (options.optimizers.empty()) throw InputError({.problem = "no optimiser is listed", .key = "enc.optimizers", .range = join(optimizers().names())});
  const Bounds bounds = bounds_of(problem.shape);

  // 1. The rounds, each with its own random stream.
  const Clock search;
  const std::size_t rounds = std::size_t(options.rounds);
  const std::size_t wanted = std::size_t(options.candidates);
  out.rounds.resize(rounds);
  std::vector<std::vector<Proposal>> pools(rounds);
  std::mutex lock;
  std::size_t finished = 0;
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
    const std::lock_guard guard(lock);
    ++finished;
    if (progress) progress("rounds", finished, rounds);
  });
  for (const auto& r : out.rounds) out.evaluations += r.evaluations;
  out.optimizers = by_optimizer(out, options.optimizers);
  out.search_s = search.seconds();

  // 2. The best distinct points in the true model.
  std::vector<Proposal> pool;
  for (auto& p : pools) pool.insert(pool.end(), p.begin(), p.end());
  const std::vector<Proposal> ranked = well_separated(std::move(pool), 3 * wanted, options.separation, bounds);
  const Eigen::MatrixXd nominal_point = Eigen::Map<const Eigen::VectorXd>(out.nominal.data(), Eigen::Index(out.nominal.size()));
  const double cost_at_nominal = out.objective.costs(problem, surrogate.means(nominal_point, 1))[0];
  decide_by_true_model(out, problem, true_model, ranked, wanted, cost_at_nominal, threads, progress);
  return out;
}

}  // namespace calomel
