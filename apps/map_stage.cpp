// What the MAP calibration needs of the other stages, and the runs that it adds to the campaign.
#include <fmt/format.h>

#include "apps/interrupt.hpp"
#include "apps/rival_fit.hpp"
#include "apps/stages.hpp"
#include "apps/unknowns.hpp"
#include "forward/campaign/added_runs.hpp"
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

Provenance Stages::added_provenance() const {
  Json options = study_.model_options();
  options["campaign"] = {{"pulses", study_.campaign.pulses}, {"pulse_energy_sd", study_.campaign.pulse_energy_sd}};
  return {.stage = "added_runs", .options = std::move(options), .seed = command_.seed, .inputs = study_.model_inputs()};
}

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
  MapModels models = models_with_errors(surrogate);
  models.surrogate = &guarded;
  MapOptions options = study_.map;
  options.likelihood = likelihood_options();
  std::optional<RivalFit> rival;  // before any long work, so that a wrong one is told at once
  if (!options.compare_with.empty()) rival = read_rival_fit(rival_directory(), model().shape(), options, hash_file(study_.recordings_file()));
  const bool unknowns = options.unknowns.young_sd > 0 || options.unknowns.gauge_place_sd > 0;
  if (unknowns)
    models.unknown_directions = [&](std::span<const double> theta) { return unknown_directions(model(), theta, options.unknowns, command_.threads); };

  const auto finer = options.mesh_pairs > 0 ? finer_model(model()) : nullptr;
  std::optional<AddedRuns> added;
  if (options.added_runs > 0 || finer) {
    const auto own = added_provenance();
    const auto journal = command_.out / "added_runs.journal";
    if (command_.fresh && journal_identity(journal) != own.identity()) set_aside(journal);
    added.emplace(model(), finer.get(), own, command_.out);
    models.has_finer = finer != nullptr;
    models.add_runs = [&](const Eigen::MatrixXd& thetas, const std::vector<bool>& with_fine) {
      auto runs = added->run(thetas, with_fine, command_.threads, [&](std::size_t done, std::size_t total) { progress("added runs", done, total); }, &stop_requested());
      seen.add(runs);
      feasibility = Feasibility(parameters, seen.theta, seen.failed);
      added->write(command_.out);
      return runs;
    };
  }
  auto summary = run_map(problem(), recordings(), *study_.recordings, models, options, command_.seed, command_.threads, progress);
  if (rival && summary.best.objective_model) {
    models.surrogate = nullptr;
    summary.rival = compare_with_rival(problem(), recordings(), *study_.recordings, models, options, summary.theta, summary.discrepancy_scale,
                                       added ? added->all() : std::vector<AddedRun>{}, *rival, command_.seed, command_.threads, progress);
  }
  write_map(summary, problem(), provenance, command_.out);
  if (summary.best.objective_model) say("map: " + summary.identification.sentence);
  if (!summary.refinement.sentence.empty()) say("map: " + summary.refinement.sentence);
  if (summary.rival) say("map: " + summary.rival->sentence);
  return summary;
}

}  // namespace calomel
