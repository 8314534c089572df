#include "apps/pipeline/case_posterior.hpp"

#include <algorithm>

#include "apps/inputs/posterior_case.hpp"
#include "apps/inputs/posterior_inputs.hpp"
#include "apps/presentation/posterior_lines.hpp"
#include "forward/campaign/archive.hpp"
#include "forward/surrogate/feasibility.hpp"
#include "forward/surrogate/surrogate.hpp"
#include "inverse/posterior/basin.hpp"

namespace calomel {

namespace {

constexpr double least_surrogate_error = 0.1;  ///< over the local amplitude, in the search for the basin

/// Where the emulator's first box stands, (n_parameters of the case).
std::vector<double> basin(StudyInputs& inputs, const PosteriorInputs& in, const CalibrationProgress& progress) {
  const auto& study = inputs.study();
  if (!basin_on_surrogate(study)) return nominal(inputs.model().shape());
  const auto surrogate = load_surrogate(inputs.artefact("surrogate.nc"));
  const Feasibility feasibility(read_archive(inputs.artefact("campaign.nc")));
  progress("basin", 0, 1);
  auto found = find_basin(
      in.problem, in.recordings, in.recording_options, in.errors, GuardedModel(*surrogate, feasibility), std::max(least_surrogate_error, in.mesh),
      [&](const std::vector<double>& theta) { return fine_run(in, theta); }, in.seed, inputs.command().threads);
  progress("basin", 1, 1);
  return found;
}

}  // namespace

CasePosterior fit_case_posterior(StudyInputs& inputs, const CalibrationProgress& progress, const NestedFit* nested) {
  const bool quick = !inputs.study().on_mesh();
  CasePosterior out{.inputs = quick ? posterior_inputs_of_a_quick_model(inputs)
                                    : posterior_inputs(inputs,
                                                       [progress](std::size_t done, std::size_t total) {
                                                         if (total > 1) progress("runs of the true model", done, total);  // one alone is a sampler's
                                                       }),
                    .fit = {}};
  PosteriorInputs& in = *out.inputs;
  const auto& study = inputs.study();
  if (const auto elements = elements_per_front(study); elements && *elements < front_resolved)
    in.warnings.push_back(front_sentence(*elements, element_sizes(study).back()));
  if (!quick) put_first_box(in, basin(inputs, in, progress));
  in.round_done = [&inputs, &parameters = in.parameters](const PosteriorRound& r) { inputs.notes().say(round_line(r, parameters)); };
  if (nested) {
    in.held = nested->held, in.nested_centre = nested->theta;
    expect_nested(*nested, in.run(Eigen::Map<const Eigen::MatrixXd>(nested->theta.data(), Eigen::Index(nested->theta.size()), 1), {0})[0], study.map);
  }
  out.fit = fit_posterior(in);
  return out;
}

const CasePosterior& FittedPosterior::get(const CalibrationProgress& progress) {
  if (!fitted_) fitted_ = std::make_unique<CasePosterior>(inputs_.study().file.locating([&] { return fit_case_posterior(inputs_, progress); }));
  return *fitted_;
}

}  // namespace calomel
