#include "apps/pipeline/diagnose_stage.hpp"

#include <fmt/format.h>

#include <chrono>

#include "apps/inputs/posterior_case.hpp"
#include "apps/inputs/posterior_inputs.hpp"
#include "apps/inputs/provenances.hpp"
#include "apps/interrupt.hpp"
#include "apps/presentation/diagnosis_course.hpp"
#include "apps/presentation/diagnosis_words.hpp"
#include "apps/presentation/posterior_lines.hpp"
#include "apps/presentation/run_lines.hpp"
#include "apps/presentation/stage_progress.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"
#include "forward/correction_groups.hpp"
#include "uq/diagnosis/diagnosis_artefacts.hpp"

namespace calomel {

ExitStatus diagnose_stage(StageCall& call) {
  auto& inputs = call.inputs;
  const auto& study = inputs.study();
  const auto& command = inputs.command();
  const auto& notes = inputs.notes();
  (void)inputs.problem();
  const auto provenance = diagnosis_provenance(inputs);
  if (!call.finished.due(provenance, {"diagnosis.json", "diagnosis.nc"}, Asked::by_user)) {
    notes.say(reused_line("diagnose"));
    return read_json(inputs.artefact("diagnosis.json")).value("status", "") == "done" ? ExitStatus::done : ExitStatus::not_to_be_trusted;
  }
  const auto start = std::chrono::steady_clock::now();
  const auto progress = [&](std::size_t done, std::size_t total) { notes.say(fmt::format("diagnose: {} of {} runs of the true model", done, total)); };
  return study.file.locating([&] {
    const bool quick = !study.on_mesh();
    const auto base = quick ? posterior_inputs_of_a_quick_model(inputs) : posterior_inputs(inputs, {});
    notes.warn(base->warnings);
    if (!quick) put_first_box(*base, nominal(inputs.model().shape()));
    base->round_done = [&](const PosteriorRound& r) { notes.say(round_line(r, base->parameters)); };
    const RunAdded run = [&](const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> added) {
      if (quick) return inputs.numbered_runs().run(thetas, added, command.threads, {}, &stop_requested());  // too quick to be told one by one
      return inputs.levels().run(thetas, level, added, command.threads, progress, &stop_requested());
    };
    const DiagnosisInputs in{.base = *base,
                             .groups = study.line       ? offered_groups(inputs.line())
                                       : study.external ? with_idle_numbers_as_shapes(offered_groups(*study.external), run, nominal(inputs.external().shape()))
                                                        : offered_groups(study.forward, inputs.model().mesh()),
                             .terms = quick ? std::vector<ParameterGroup>{} : correction_groups(study.forward),
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
