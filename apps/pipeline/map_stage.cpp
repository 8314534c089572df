// The stage that finds the mode of the posterior.
#include <fmt/format.h>

#include "apps/interrupt.hpp"
#include "apps/pipeline/nested_fit.hpp"
#include "apps/pipeline/posterior_stage.hpp"
#include "apps/pipeline/stages.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"

namespace calomel {

std::filesystem::path Stages::nested_directory() const { return command_.case_file.parent_path() / study_.map.compare_with; }

MapSummary Stages::calibrate_map(const Provenance& provenance, const CalibrationProgress& progress) {
  std::optional<NestedFit> nested;  // before any long work, so that a wrong one is told at once
  if (!study_.map.compare_with.empty())
    nested = read_nested_fit(nested_directory(), posterior_parameters(study_, model().shape()), model().shape().parameters.size(), study_.map, hash_file(study_.recordings_file()));
  const auto with_nested = nested ? fit_case_posterior(progress, &*nested) : nullptr;
  const CasePosterior* made = nested ? with_nested.get() : &case_posterior(progress);
  std::function<std::vector<MechanismDirections>(std::span<const double>)> left_out;
  if (study_.map.score_tests)
    left_out = [&](std::span<const double>) {
      return made->runs->mechanisms(made->fit.modes[0].at.theta, command_.threads, [&](std::size_t done, std::size_t all) { progress("runs of the score tests", done, all); }, &stop_requested());
    };
  auto summary = run_map(*made->inputs, made->fit, study_.map.product, left_out, nested ? &nested->model : nullptr);
  write_map(summary, *made->inputs, made->fit, provenance, command_.out);
  if (summary.status != CalibrationStatus::no_candidate) say("map: " + summary.identification.sentence);
  say("map: " + summary.check.sentence);
  if (summary.score_tests) say("map: " + summary.score_tests->sentence);
  if (summary.nested) say("map: " + summary.nested->sentence);
  return summary;
}

}  // namespace calomel
