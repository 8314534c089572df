#include "apps/pipeline/map_stage.hpp"

#include "apps/inputs/provenances.hpp"
#include "apps/presentation/calibration_lines.hpp"
#include "apps/presentation/data_check_words.hpp"
#include "apps/presentation/fit_words.hpp"
#include "base/artefact.hpp"
#include "uq/data_checks.hpp"

namespace calomel {

std::optional<NestedFit> compared_fit(StudyInputs& inputs) {
  const auto& study = inputs.study();
  if (study.map.compare_with.empty()) return std::nullopt;
  return study.file.locating([&] {
    return read_nested_fit(nested_directory(inputs), posterior_parameters(*study.simulator, study.posterior_settings()), study.parameters().size(), study.map,
                           hash_file(study.recordings_file()));
  });
}

MapSummary map_stage(StageCall& call, const Provenance& provenance, const CalibrationProgress& progress) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  const auto& options = inputs.study().map;
  const auto nested = compared_fit(inputs);
  std::optional<CasePosterior> with_nested;
  if (nested) with_nested = fit_case_posterior(inputs, progress, &*nested);
  const CasePosterior& made = nested ? *with_nested : call.posterior.get(progress);
  std::function<std::vector<MechanismDirections>(std::span<const double>)> left_out;
  if (options.score_tests && !inputs.study().capabilities().cheap_runs)
    left_out = [&](std::span<const double>) {
      return mechanism_directions(meshed_runs(inputs.runs(), inputs.study().posterior_settings()), made.fit.modes[0].at.theta,
                                  [&](std::size_t done, std::size_t all) { progress("runs of the score tests", done, all); });
    };
  auto summary = run_map(*made.inputs, made.fit, options.product, left_out, nested ? &nested->model : nullptr);
  summary.message = map_message(summary, made.fit);
  const auto checks = data_check_sentences(check_data(*made.inputs, made.fit), made.inputs->errors);
  summary.warnings.insert(summary.warnings.begin(), checks.begin(), checks.end());
  const auto doubts = map_warnings(summary, *made.inputs, made.fit);
  summary.warnings.insert(summary.warnings.end(), doubts.begin(), doubts.end());
  const MapWords words = map_words(summary, made.fit);
  write_map(summary, *made.inputs, made.fit, words, provenance, command.out);
  inputs.notes().say(map_lines(summary, words));
  return summary;
}

}  // namespace calomel
