#pragma once
/// What a fit of the posterior works on, from a case.
#include <memory>
#include <span>
#include <vector>

#include "apps/inputs/study_inputs.hpp"
#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

/// All of it but where the first box stands (put_first_box) and what is told and held. Runs are those of inputs.levels(); `told` of them. `inputs` outlives it.
/// Errors: InputError with its place for recordings or meshes.
std::unique_ptr<PosteriorInputs> posterior_inputs(StudyInputs& inputs, const RunStore::Progress& told);

/// What a fit works on, from its parts, which outlive it; runs are those of `runs`.
struct PosteriorParts {
  const StudyCase& study;
  LevelRuns& runs;
  const Problem& problem;
  const Recordings& recordings;
  const RecordingOptions& recording_options;
};
std::unique_ptr<PosteriorInputs> posterior_inputs(const PosteriorParts& parts, const CommandLine& command, const RunStore::Progress& told);

/// The same of a line, its first box about the nominal values and as wide as the priors, or of a model outside, whose first box stands where it fits. Errors:
/// InputError with its place where nothing may move, or for times of [errors] that are far below the line's.
std::unique_ptr<PosteriorInputs> posterior_inputs_of_a_quick_model(StudyInputs& inputs);

/// The same without a first box.
std::unique_ptr<PosteriorInputs> posterior_inputs_without_start(StudyInputs& inputs);

/// The ensemble mean of the finest mesh at `theta`, (n_parameters of the case), nuisances at the middle of their priors; (values), empty where it fails.
std::vector<double> fine_run(const PosteriorInputs& in, std::vector<double> theta);

/// Puts the emulator's first box about `basin`, (n_parameters of the case).
void put_first_box(PosteriorInputs& in, std::span<const double> basin);

}  // namespace calomel
