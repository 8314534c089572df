// What the MAP calibration needs of the other stages.
#include <fmt/format.h>

#include "apps/left_out.hpp"
#include "apps/rival_fit.hpp"
#include "apps/stages.hpp"
#include "apps/unknowns.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"
#include "inverse/feasibility.hpp"

namespace calomel {

namespace {

/// The runs that failed and those that did not, the added ones too.
struct SeenRuns {
  Eigen::MatrixXd theta;
  std::vector<bool> failed;
  explicit SeenRuns(const Archive& archive) : theta(archive.theta) {
    for (const auto s : archive.status) failed.push_back(s == RunStatus::failed);
  }
  void add(const std::vector<AddedRun>& runs) {
    for (const auto& r : runs) {
      theta.conservativeResize(Eigen::NoChange, theta.cols() + 1);
      theta.col(theta.cols() - 1) = Eigen::Map<const Eigen::VectorXd>(r.theta.data(), Eigen::Index(r.theta.size()));
      failed.push_back(!r.working.done);
    }
  }
};

}  // namespace

std::filesystem::path Stages::rival_directory() const { return command_.case_file.parent_path() / study_.map.compare_with; }

void Stages::say_failures(const Archive& archive, const Feasibility& feasibility) const {
  if (!feasibility.any_failed()) return;
  say(fmt::format("{} of {} runs of the campaign failed and are left out; searches keep off where runs are likely to fail ({:.0f} % of the runs are told rightly from the others)",
                  feasibility.failures(), archive.runs(), 100 * feasibility.leave_one_out_accuracy()));
  for (const auto& [reason, count] : failure_reasons(archive)) say(fmt::format("  {} x {}", count, reason));
}

MapSummary Stages::calibrate_map(const Provenance& provenance, const Surrogate& surrogate, const Archive& archive, const CalibrationProgress& progress) {
  const auto& parameters = model().shape().parameters;
  SeenRuns seen(archive);
  Feasibility feasibility(parameters, seen.theta, seen.failed);
  say_failures(archive, feasibility);
  const GuardedModel guarded(surrogate, feasibility);
  MapModels models = models_with_errors(model(), &surrogate);
  models.surrogate = &guarded;
  MapOptions options = study_.map;
  options.likelihood = likelihood_options();
  std::optional<RivalFit> rival;  // before any long work, so that a wrong one is told at once
  if (!options.compare_with.empty()) rival = read_rival_fit(rival_directory(), model().shape(), options, hash_file(study_.recordings_file()));
  const bool unknowns = options.unknowns.young_sd > 0 || options.unknowns.gauge_place_sd > 0;
  if (unknowns)
    models.unknown_directions = [&](std::span<const double> theta) { return unknown_directions(model(), theta, options.unknowns, command_.threads); };
  if (options.screen) models.left_out = [&](std::span<const double> theta) { return left_out_directions(model(), theta, command_.threads); };

  auto added = added_runs("map", options.added_runs > 0, options.mesh_pairs > 0);
  const RunSource source = run_source(added, progress);
  models.has_finer = source.has_finer;
  if (source.run)
    models.add_runs = [&](const Eigen::MatrixXd& thetas, const std::vector<bool>& with_fine) {
      auto runs = source.run(thetas, with_fine);
      seen.add(runs);
      feasibility = Feasibility(parameters, seen.theta, seen.failed);
      return runs;
    };
  auto summary = run_map(problem(), recordings(), *study_.recordings, models, options, command_.seed, command_.threads, progress);
  if (rival && summary.best.objective_model) {
    models.surrogate = nullptr;
    summary.rival = compare_with_rival(problem(), recordings(), *study_.recordings, models, options, summary.theta, summary.discrepancy_scale,
                                       added.runs ? added.runs->all() : std::vector<AddedRun>{}, *rival, command_.seed, command_.threads, progress);
  }
  write_map(summary, problem(), provenance, command_.out);
  if (summary.best.objective_model) say("map: " + summary.identification.sentence);
  if (!summary.refinement.sentence.empty()) say("map: " + summary.refinement.sentence);
  if (summary.screening) say("map: " + summary.screening->sentence);
  if (summary.rival) say("map: " + summary.rival->sentence);
  return summary;
}

}  // namespace calomel
