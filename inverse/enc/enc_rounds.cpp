#include "inverse/enc/enc_rounds.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "base/not_finite.hpp"
#include "base/parallel.hpp"
#include "base/random.hpp"

namespace calomel {

namespace {

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

}  // namespace

Rounds search_rounds(const Problem& problem, const ForwardModel& surrogate, const Objective& objective, const RoundPlan& plan, std::uint64_t seed, int threads,
                     const std::function<void(std::size_t done)>& done) {
  const Bounds bounds = bounds_of(problem.shape);
  const BatchCost cost(problem, surrogate, objective);
  Rounds out;
  out.rounds.resize(plan.rounds);
  std::vector<std::vector<Proposal>> pools(plan.rounds);
  std::mutex lock;
  std::size_t finished = 0;
  parallel_for(plan.rounds, threads, [&](std::size_t round) {
    const std::uint64_t stream = plan.first_stream + round;
    RandomStream draw(seed, stream);
    const std::string& name = plan.optimizers[draw.below(plan.optimizers.size())];
    EncRound& r = out.rounds[round];
    if (name == gradient_search) {
      r = gradient_round(problem, surrogate, objective, cost, bounds, plan.population, draw(), stream);
    } else {
      Visited visited(bounds, plan.cell);
      const BatchFunction function = [&](const Eigen::MatrixXd& points, std::span<double> values) {
        const auto costs = cost(points);
        std::copy(costs.begin(), costs.end(), values.begin());
        if (plan.pool > 0) visited.add(points, values);
      };
      const auto result = minimise(optimizers().get(name), function, bounds, {plan.generations, plan.population}, draw(), stream);
      const auto published = [&](double cost) { return std::isfinite(cost) ? objective.cost(cost) : nan; };
      r = {name, {result.x.begin(), result.x.end()}, published(result.f), {}, result.evaluations};
      for (const double f : result.trace) r.trace.push_back(published(f));
      pools[round] = visited.best(plan.pool);
    }
    const std::lock_guard guard(lock);
    ++finished;
    if (done) done(finished);
  });
  for (auto& p : pools) out.pool.insert(out.pool.end(), p.begin(), p.end());
  return out;
}

}  // namespace calomel
