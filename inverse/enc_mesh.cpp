#include "inverse/enc_mesh.hpp"

#include <algorithm>

namespace calomel {

namespace {

constexpr std::uint64_t first_stream = 900'000'000, mesh_streams_apart = 100'000;  // apart from those of the calibration and of what it is compared with
constexpr double stays = 0.01;           ///< of the bounds: an optimum that moves by less has settled
constexpr std::size_t later_pairs = 2;   ///< of a round after the first

}  // namespace

void CorrectedSurrogate::learn() {
  Eigen::MatrixXd theta(pairs_.thetas().rows(), 0), working(pairs_.working().rows(), 0);
  for (Eigen::Index i = 0; i < pairs_.thetas().cols(); ++i) {
    const Eigen::VectorXd t = pairs_.thetas().col(i);
    if (!surrogate_.evaluate({t.data(), std::size_t(t.size())}).ok) continue;  // where runs are likely to fail
    theta.conservativeResize(Eigen::NoChange, theta.cols() + 1), working.conservativeResize(Eigen::NoChange, working.cols() + 1);
    theta.rightCols(1) = t, working.rightCols(1) = pairs_.working().col(i);
  }
  shifted_.reset(), refined_.reset();
  if (theta.cols() >= 2) refined_.emplace(surrogate_, variance_, theta, working);
  shifted_.emplace(refined_ ? static_cast<const ForwardModel&>(*refined_) : surrogate_, pairs_.mesh());
}

const ForwardModel& CorrectedSurrogate::model() const { return shifted_ ? static_cast<const ForwardModel&>(*shifted_) : surrogate_; }

RefinedModel::Variance CorrectedSurrogate::variance() const {
  if (!variance_ || !refined_) return variance_;
  return [&refined = *refined_](std::span<const double> theta) { return refined.error_variance(theta); };
}

void learn_mesh(EncSummary& out, const Problem& problem, const ForwardModel& surrogate, const Archive& archive, MeshPairs& pairs, CorrectedSurrogate& corrected,
                RoundPlan plan, double separation, std::uint64_t seed, int threads, const CalibrationProgress& progress) {
  const Bounds bounds = bounds_of(problem.shape);
  const auto wanted = std::size_t(pairs.left());
  plan.rounds = std::max<std::size_t>(4, plan.rounds / 10), plan.pool = 20, plan.first_stream = first_stream;
  const auto search = [&](const ForwardModel& model) {
    auto found = search_rounds(problem, model, out.objective, plan, seed, threads, [&](std::size_t done) {
      if (progress) progress("rounds to place pairs of runs", done, plan.rounds);
    });
    plan.first_stream += mesh_streams_apart;
    for (const auto& r : found.rounds) out.evaluations += r.evaluations;
    return well_separated(std::move(found.pool), 10, separation, bounds);
  };

  // 1. What is known before any pair.
  std::vector<std::vector<double>> given{out.nominal};
  auto ranked = search(surrogate);
  if (!ranked.empty()) out.mesh.without = ranked[0].theta, given.push_back(ranked[0].theta);
  const auto cost = [&](std::span<const double> theta, std::span<const double> values) {
    return out.objective.cost(value_of_run(out.objective, theta, values, score(problem, values)));
  };
  auto points = first_pair_points(given, ranked_runs(archive, cost), std::min(wanted, std::max<std::size_t>(3, (wanted + 1) / 2)), bounds);

  // 2. Pairs, and the search with them.
  while (!points.empty() && pairs.left() > 0) {
    pairs.add(points, points.size());
    corrected.learn();
    const Proposal before = ranked.empty() ? Proposal{0, out.nominal} : ranked[0];
    ranked = search(corrected.model());
    if (ranked.empty()) return;
    out.mesh.rounds.push_back({pairs.asked(), ranked[0].theta, distance(ranked[0], before, bounds)});
    out.mesh.settled = out.mesh.rounds.size() > 1 && out.mesh.rounds.back().moved < stays;
    points.clear();
    if (out.mesh.settled) return;
    for (const auto& p : ranked)
      if (points.size() < std::min(later_pairs, std::size_t(pairs.left())) && !pairs.paired(p.theta)) points.push_back(p.theta);
  }
}

}  // namespace calomel
