#include "apps/pipeline/case_posterior.hpp"

#include <optional>

#include "apps/inputs/provenances.hpp"
#include "apps/presentation/posterior_lines.hpp"
#include "forward/campaign/archive.hpp"
#include "forward/surrogate/feasibility.hpp"
#include "forward/surrogate/surrogate.hpp"
#include "inverse/posterior/emulator_meshes.hpp"

namespace calomel {

CasePosterior fit_case_posterior(StudyInputs& inputs, const CalibrationProgress& progress, const NestedFit* nested) {
  const auto& study = inputs.study();
  PosteriorCase posterior_case = inputs.posterior_case();
  const bool cheap = study.capabilities().cheap_runs;
  if (!cheap)
    posterior_case.progress = [progress](std::size_t done, std::size_t total) {
      if (total > 1) progress("runs of the true model", done, total);  // one alone is a sampler's
    };
  posterior_case.basin_progress = [&](std::size_t done, std::size_t total) { progress("basin", done, total); };
  std::unique_ptr<Surrogate> surrogate;
  std::optional<Feasibility> feasibility;
  std::optional<GuardedModel> guarded;
  if (basin_on_surrogate(study)) {
    surrogate = load_surrogate(inputs.artefact("surrogate.nc"));
    feasibility.emplace(read_archive(inputs.artefact("campaign.nc")));
    guarded.emplace(*surrogate, *feasibility);
    posterior_case.surrogate = &*guarded;
  }
  CasePosterior out{.inputs = set_up_posterior(posterior_case), .fit = {}};
  PosteriorInputs& in = *out.inputs;
  in.warnings = setup_sentences(in.findings);
  if (const auto elements = elements_per_front(inputs.simulator(), study.emulator); elements && *elements < front_resolved)
    in.warnings.push_back(front_sentence(*elements, element_sizes(inputs.simulator(), study.emulator).back()));
  if (nested) {
    in.held = nested->held;
    in.nested_centre = nested->theta;
    expect_nested(*nested, in.run(Eigen::Map<const Eigen::MatrixXd>(nested->theta.data(), Eigen::Index(nested->theta.size()), 1), {0})[0], study.map);
  }
  out.fit = fit_posterior(in, {.round_done = [&](const PosteriorRound& r) { inputs.notes().say(round_line(r, in.parameters)); }, .go_on = {}});
  return out;
}

const CasePosterior& FittedPosterior::get(const CalibrationProgress& progress) {
  if (!fitted_) fitted_ = std::make_unique<CasePosterior>(inputs_.study().file.locating([&] { return fit_case_posterior(inputs_, progress); }));
  return *fitted_;
}

}  // namespace calomel
