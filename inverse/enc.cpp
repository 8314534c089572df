#include "inverse/enc.hpp"

#include "base/nan.hpp"
#include "inverse/enc_mesh.hpp"
#include "inverse/enc_spread.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace calomel {

namespace {

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

bool EncOptions::needs_likelihood() const {
  return objective == correlated_name || std::find(compare_objectives.begin(), compare_objectives.end(), correlated_name) != compare_objectives.end();
}

EncSummary run_enc(const Problem& problem, const ForwardModel& surrogate, const ForwardModel& true_model, const EncOptions& options, std::uint64_t seed,
                   int threads, const CalibrationProgress& progress, const Likelihood* likelihood, const EncRuns* runs) {
  const auto& parameters = problem.shape.parameters;
  expect(surrogate.shape().values() == problem.shape.values() && true_model.shape().values() == problem.shape.values(),
         "surrogate, true model and problem have one shape");
  expect(!parameters.empty() && surrogate.shape().parameters.size() == parameters.size(), "there are parameters to calibrate");
  EncSummary out{begin_calibration(problem, objective_named(options.objective, likelihood, "enc.objective"))};
  for (const auto& name : options.optimizers) (void)optimizers().get(name, "enc.optimizers");
  if (options.optimizers.empty()) throw InputError({.problem = "no optimiser is listed", .key = "enc.optimizers", .range = join(optimizers().names())});

  // 1. The mesh's error, where pairs of runs tell it.
  const std::size_t wanted = std::size_t(options.candidates);
  RoundPlan plan{.optimizers = options.optimizers, .rounds = std::size_t(options.rounds), .generations = options.generations, .population = options.population,
                 .cell = options.separation, .pool = 20 * wanted};
  const Clock search;
  const RunSource no_source;
  const RememberingModel model(true_model);
  MeshPairs pairs(problem.shape, runs ? runs->source : no_source, model, options.mesh_pairs, options.mesh_beyond);
  CorrectedSurrogate corrected(surrogate, pairs, runs ? runs->surrogate_variance : RefinedModel::Variance());
  const bool paired = pairs.left() > 0;
  if (paired) learn_mesh(out, problem, surrogate, runs->archive, pairs, corrected, plan, options.separation, seed, threads, progress);
  const ShiftedModel shifted(model, pairs.mesh());

  // 2. The rounds.
  auto found = search_rounds(problem, corrected.model(), out.objective, plan, seed, threads, [&](std::size_t done) {
    if (progress) progress("rounds", done, plan.rounds);
  });
  out.rounds = std::move(found.rounds);
  for (const auto& r : out.rounds) out.evaluations += r.evaluations;
  out.optimizers = by_optimizer(out, options.optimizers);

  // 3. The best distinct points in the true model.
  const Bounds bounds = bounds_of(problem.shape);
  const std::vector<Proposal> ranked = well_separated(std::move(found.pool), 3 * wanted, options.separation, bounds);
  const Eigen::MatrixXd nominal_point = Eigen::Map<const Eigen::VectorXd>(out.nominal.data(), Eigen::Index(out.nominal.size()));
  const double cost_at_nominal = out.objective.costs(problem, corrected.model().means(nominal_point, 1), nominal_point)[0];
  if (paired) pairs.run_unknown(ranked, wanted);
  out.search_s = search.seconds() - pairs.seconds(), out.model_s = pairs.seconds();
  decide_by_true_model(out, problem, shifted, ranked, wanted, cost_at_nominal, threads, progress,
                       [&](std::span<const double> theta, std::span<const double> values, const Score& score) { return value_of_run(out.objective, theta, values, score); });
  out.model_runs = model.runs();
  pairs.describe(out, problem);

  // 4. How sure the answer is.
  if (runs && runs->errors && options.draws > 0 && out.trusted())
    spread_enc(out, problem, corrected.model(), [&] { return runs->errors(out.theta, pairs.mesh(), corrected.variance()); }, options, likelihood, seed, threads, progress);

  // 5. Whether other optimisers and objectives lead to the same answer.
  plan.rounds = std::size_t(options.compare_rounds), plan.pool = 0;
  const Clock comparing;
  out.agreement = find_agreement(problem, corrected.model(), shifted, out.objective, out.rounds,
                                 {.optimizers = options.compare_optimizers, .objectives = options.compare_objectives, .rounds = plan, .tolerance = options.agreement},
                                 likelihood, seed, threads, progress);
  out.agreement_s = comparing.seconds();
  return out;
}

}  // namespace calomel
