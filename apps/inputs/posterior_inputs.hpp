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

/// The ensemble mean of the finest mesh at `theta`, (n_parameters of the case), nuisances at the middle of their priors; (values), empty where it fails.
std::vector<double> fine_run(const PosteriorInputs& in, std::vector<double> theta);

/// Puts the emulator's first box about `basin`, (n_parameters of the case).
void put_first_box(PosteriorInputs& in, std::span<const double> basin);
/// The same for a line: about its nominal values, as wide as its priors.
void put_first_box_of_a_line(PosteriorInputs& in);

}  // namespace calomel
