// Runs of the true model that calibrations add to a campaign, from one journal in --out.
#include "apps/interrupt.hpp"
#include "apps/stages.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"

namespace calomel {

Provenance Stages::added_provenance() const {
  Json options = study_.model_options();
  options["campaign"] = {{"pulses", study_.campaign.pulses}, {"pulse_energy_sd", study_.campaign.pulse_energy_sd}};
  return {.stage = "added_runs", .options = std::move(options), .seed = command_.seed, .inputs = study_.model_inputs()};
}

AddedStage Stages::added_runs(const std::string& method, bool alone, bool paired) {
  AddedStage stage{.method = method};
  if (paired) stage.finer = finer_model(model());
  if (!alone && !stage.finer) return stage;
  const auto own = added_provenance();
  const auto journal = command_.out / "added_runs.journal";
  if (command_.fresh && journal_identity(journal) != own.identity()) set_aside(journal);
  stage.runs = std::make_unique<AddedRuns>(model(), stage.finer.get(), own, command_.out);
  return stage;
}

RunSource Stages::run_source(AddedStage& stage, const CalibrationProgress& progress) {
  RunSource source{.run = {}, .has_finer = stage.finer != nullptr};
  if (!stage.runs) return source;
  source.run = [this, &stage, progress](const Eigen::MatrixXd& thetas, const std::vector<bool>& with_fine) {
    auto runs = stage.runs->run(thetas, with_fine, command_.threads, [&](std::size_t done, std::size_t total) { progress("added runs", done, total); }, &stop_requested());
    stage.runs->write(command_.out, stage.method);
    return runs;
  };
  return source;
}

}  // namespace calomel
