#include "inverse/enc_spread.hpp"

#include <algorithm>
#include <limits>
#include <mutex>

#include "base/parallel.hpp"

namespace calomel {

namespace {

constexpr std::uint64_t search_stream = 950'000'000, boxes_apart = 100'000;
constexpr double half_side = 0.1;   ///< of the first box, in units of the bounds
constexpr double edge = 0.05;       ///< of a side: a best point so near its end lies beyond it
constexpr int boxes = 4;
constexpr int generations = 30, population = 24;

/// The problem on the box of `half` of the bounds about `middle`.
Problem on_box(const Problem& problem, const Bounds& bounds, const std::vector<double>& middle, double half) {
  Problem p = problem;
  for (std::size_t k = 0; k < middle.size(); ++k) {
    const double low = bounds.low[Eigen::Index(k)], high = bounds.high[Eigen::Index(k)], side = std::min(1.0, 2 * half) * (high - low);
    p.shape.parameters[k].min = std::clamp(middle[k] - side / 2, low, high - side);
    p.shape.parameters[k].max = p.shape.parameters[k].min + side;
  }
  return p;
}

bool at_end(const std::vector<double>& theta, const Problem& box, const Bounds& bounds) {
  for (std::size_t k = 0; k < theta.size(); ++k) {
    const auto& p = box.shape.parameters[k];
    const double near = edge * (p.max - p.min);
    if ((theta[k] < p.min + near && p.min > bounds.low[Eigen::Index(k)]) || (theta[k] > p.max - near && p.max < bounds.high[Eigen::Index(k)])) return true;
  }
  return false;
}

/// One draw, from the search to the decision.
class EncDraw {
 public:
  EncDraw(const EncSummary& out, const Problem& problem, const ForwardModel& surrogate, const EncOptions& options, const Likelihood* likelihood, std::uint64_t seed)
      : out_(out), surrogate_(surrogate), options_(options), likelihood_(likelihood), seed_(seed), bounds_(bounds_of(problem.shape)) {}

  /// The drawn answer; empty where the surrogate fails everywhere.
  [[nodiscard]] std::vector<double> answer(const DrawnErrors& errors, std::size_t draw) const {
    const auto records = errors.records(draw);
    const DrawnShift shift = errors.shift(draw);
    const DrawnModel surrogate(surrogate_, shift);
    auto ranked = well_separated(search(surrogate, records, draw), std::size_t(options_.candidates), options_.separation, bounds_);
    if (ranked.empty()) return {};
    ranked.push_back({0, out_.nominal});
    Eigen::MatrixXd points(bounds_.low.size(), Eigen::Index(ranked.size()));
    for (std::size_t i = 0; i < ranked.size(); ++i) points.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXd>(ranked[i].theta.data(), points.rows());
    const Eigen::MatrixXf runs = surrogate.means(points, 1) + errors.runs(draw, 0, ranked.size());
    std::optional<Likelihood> moved;
    const auto costs = objective(moved, records.moved).costs(records.of_runs, runs, points);
    const auto best = std::min_element(costs.begin(), costs.end());
    return std::isfinite(*best) ? ranked[std::size_t(best - costs.begin())].theta : std::vector<double>{};
  }

 private:
  /// The calibration's objective; the correlated one, which holds the records itself, with these moved in `moved`.
  [[nodiscard]] Objective objective(std::optional<Likelihood>& moved, const Eigen::VectorXd& by) const {
    if (!out_.objective.of_histories) return out_.objective;
    moved.emplace(likelihood_->moved(by));
    return correlated_objective(*moved);
  }

  [[nodiscard]] std::vector<Proposal> search(const ForwardModel& surrogate, const DrawnErrors::Records& records, std::size_t draw) const {
    std::optional<Likelihood> moved;
    const Objective sought = objective(moved, records.moved_surrogate);
    std::vector<double> middle = out_.theta;
    std::vector<Proposal> pool;
    double half = half_side;
    for (int i = 0; i < boxes; ++i, half *= 1.5) {
      const Problem box = on_box(records.of_surrogate, bounds_, middle, half);
      const RoundPlan plan{.optimizers = {"de"}, .rounds = 1, .generations = generations, .population = population, .cell = options_.separation / std::min(1.0, 2 * half),
                           .pool = 20 * std::size_t(options_.candidates), .first_stream = search_stream + std::uint64_t(i) * boxes_apart + draw};
      auto found = search_rounds(box, surrogate, sought, plan, seed_, 1);
      pool.insert(pool.end(), found.pool.begin(), found.pool.end());
      if (pool.empty()) break;
      middle = std::min_element(pool.begin(), pool.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; })->theta;
      if (!at_end(middle, box, bounds_)) break;
    }
    return pool;
  }

  const EncSummary& out_;
  const ForwardModel& surrogate_;
  const EncOptions& options_;
  const Likelihood* likelihood_;
  std::uint64_t seed_;
  Bounds bounds_;
};

}  // namespace

void spread_enc(EncSummary& out, const Problem& problem, const ForwardModel& surrogate, const std::function<AnswerErrors()>& errors, const EncOptions& options,
                const Likelihood* likelihood, std::uint64_t seed, int threads, const CalibrationProgress& progress) {
  const auto predicted = surrogate.evaluate(out.theta);
  if (!predicted.ok) {
    out.spread.wanted = options.draws;
    out.spread.sentence = "no standard deviations: the surrogate has no value at the answer";
    return;
  }
  const EncDraw calibration(out, problem, surrogate, options, likelihood, seed);
  draw_answers(out.spread, problem, errors, options.draws, out.theta, predicted.mean, seed, threads, progress,
               [&](const DrawnErrors& drawn, std::size_t k) { return calibration.answer(drawn, k); });
}

}  // namespace calomel
