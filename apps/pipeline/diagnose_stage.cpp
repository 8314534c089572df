#include "apps/pipeline/diagnose_stage.hpp"

#include <fmt/format.h>

#include <chrono>

#include "apps/inputs/provenances.hpp"
#include "apps/presentation/diagnosis_course.hpp"
#include "apps/presentation/diagnosis_words.hpp"
#include "apps/presentation/posterior_lines.hpp"
#include "apps/presentation/run_lines.hpp"
#include "apps/presentation/stage_progress.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"
#include "uq/diagnosis/diagnosis_artefacts.hpp"

namespace calomel {

ExitStatus diagnose_stage(StageCall& call) {
  auto& inputs = call.inputs;
  const auto& study = inputs.study();
  const auto& notes = inputs.notes();
  (void)inputs.problem();
  const auto provenance = diagnosis_provenance(inputs);
  if (!call.finished.due(provenance, {"diagnosis.json", "diagnosis.nc"}, Requested::by_user)) {
    notes.say(reused_line("diagnose"));
    return read_json(inputs.artefact("diagnosis.json")).value("status", "") == "done" ? ExitStatus::done : ExitStatus::not_to_be_trusted;
  }
  const auto start = std::chrono::steady_clock::now();
  return study.file.locating([&] {
    const bool cheap = study.capabilities().cheap_runs;
    const Runs::Progress progress = [&](std::size_t done, std::size_t total) {
      if (!cheap) notes.say(fmt::format("diagnose: {} of {} runs of the true model", done, total));  // cheap runs are too many to be reported one by one
    };
    const PosteriorCase posterior_case = inputs.posterior_case();
    const auto base = set_up_posterior(posterior_case);
    base->warnings = setup_sentences(base->findings);
    notes.warn(base->warnings);
    const MeshedRuns runs = meshed_runs(posterior_case.runs, posterior_case.settings);
    const RunAdded run = [&](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> added) {
      return runs.get(thetas, level, added, progress);
    };
    auto groups = inputs.simulator().offered();
    if (inputs.simulator().hints().idle_numbers) groups = with_idle_numbers_as_shapes(std::move(groups), run, nominal(inputs.simulator().shape()));
    const DiagnosisInputs in{.base = *base,
                             .groups = std::move(groups),
                             .terms = inputs.simulator().terms(),
                             .run = run,
                             .options = study.diagnosis,
                             .report = [&](const DiagnosisEvent& event) { notes.say(stage_line("diagnose", event_text(event))); },
                             .round = [&](const PosteriorRound& r, const std::vector<Parameter>& parameters) { notes.say(round_line(r, parameters)); }};
    const Diagnosis d = diagnose(in);
    const DiagnosisText words = diagnosis_text(d, in.groups);
    Json json = diagnosis_json(d, in, words, provenance);
    const bool trusted = d.unsettled().empty();
    json["warnings"] = base->warnings;
    json["status"] = trusted ? "done" : "not_to_be_trusted";
    json["wall_s"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();  // of this call
    write_diagnosis_histories(d, base->problem, provenance, inputs.artefact("diagnosis.nc"));
    write_json(inputs.artefact("diagnosis.json"), json);
    notes.say(stage_line("diagnose", fmt::format("verdict: {}{}: {}", text(d.verdict.kind),
                                                 d.verdict.mechanisms.empty() ? "" : " " + join(d.verdict.mechanisms), words.reason)));
    notes.say(words.summary());
    return trusted ? ExitStatus::done : ExitStatus::not_to_be_trusted;
  });
}

}  // namespace calomel
