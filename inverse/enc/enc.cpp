#include "inverse/enc/enc.hpp"

#include "base/not_finite.hpp"
#include "forward/emulator/mesh_correction.hpp"
#include "inverse/calibration/remembering_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace calomel {

namespace {

constexpr std::uint64_t bare_stream = 900'000'000;  ///< apart from those of the calibration and of what it is compared with

std::vector<EncOptimizer> by_optimizer(const EncSummary& summary, const std::vector<std::string>& names) {
  std::vector<EncOptimizer> all;
  for (const auto& name : names) {
    EncOptimizer o{name};
    double sum = 0, squares = 0, best = std::numeric_limits<double>::infinity();
    for (const auto& r : summary.rounds) {
      if (r.optimizer != name || !std::isfinite(r.objective)) continue;
      ++o.rounds;
      sum += r.objective;
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
                   int threads, const CalibrationProgress& progress, const MeshCorrection* correction) {
  const auto& parameters = problem.shape.parameters;
  expect(surrogate.shape().values() == problem.shape.values() && true_model.shape().values() == problem.shape.values(),
         "surrogate, true model and problem have one shape");
  expect(!parameters.empty() && surrogate.shape().parameters.size() == parameters.size(), "there are parameters to calibrate");
  EncSummary out{begin_calibration(problem, objectives().get(options.objective, "enc.objective"))};
  for (const auto& name : options.optimizers) (void)optimizers().get(name, "enc.optimizers");
  if (options.optimizers.empty()) throw InputError({.problem = "no optimiser is listed", .key = "enc.optimizers", .range = join(optimizers().names())});
  const MeshCorrection none, &mesh = correction ? *correction : none;
  const CorrectedModel searched(surrogate, mesh);
  const RememberingModel model(true_model);
  const CorrectedModel decided(model, mesh);

  // 1. The rounds; before them, where predictions are corrected, a few without, to show the effect.
  const std::size_t wanted = std::size_t(options.candidates);
  RoundPlan plan{.optimizers = options.optimizers,
                 .rounds = std::size_t(options.rounds),
                 .generations = options.generations,
                 .population = options.population,
                 .cell = options.separation,
                 .pool = 20 * wanted};
  const Clock search;
  const auto rounds = [&](const ForwardModel& on, const RoundPlan& p, const char* what) {
    auto found = search_rounds(problem, on, out.objective, p, seed, threads, [&](std::size_t done) {
      if (progress) progress(what, done, p.rounds);
    });
    for (const auto& r : found.rounds) out.evaluations += r.evaluations;
    return found;
  };
  const Bounds bounds = bounds_of(problem.shape);
  if (!mesh.empty()) {
    RoundPlan few = plan;
    few.rounds = std::max<std::size_t>(4, plan.rounds / 10);
    few.pool = 1;
    few.first_stream = bare_stream;
    if (auto best = well_separated(rounds(surrogate, few, "rounds without the correction").pool, 1, 0, bounds); !best.empty()) out.mesh.without = best[0].theta;
  }
  auto found = rounds(searched, plan, "rounds");
  out.rounds = std::move(found.rounds);
  out.optimizers = by_optimizer(out, options.optimizers);

  // 2. The best distinct points in the true model.
  const std::vector<Proposal> ranked = well_separated(std::move(found.pool), 3 * wanted, options.separation, bounds);
  const Eigen::MatrixXd nominal_point = Eigen::Map<const Eigen::VectorXd>(out.nominal.data(), Eigen::Index(out.nominal.size()));
  const double cost_at_nominal = out.objective.costs(problem, searched.means(nominal_point, 1))[0];
  out.search_s = search.seconds();
  decide_by_true_model(out, problem, decided, ranked, wanted, cost_at_nominal, threads, progress);
  out.model_runs = model.runs();
  report_correction(out, problem, mesh);

  // 3. Whether other optimisers and objectives lead to the same answer.
  plan.rounds = compared_rounds;
  plan.pool = 0;
  const Clock comparing;
  out.agreement = find_agreement(problem, searched, decided, out.objective, out.rounds,
                                 {.optimizers = options.compare_optimizers, .objectives = options.compare_objectives, .rounds = plan}, seed, threads, progress);
  out.agreement_s = comparing.seconds();
  return out;
}

}  // namespace calomel
