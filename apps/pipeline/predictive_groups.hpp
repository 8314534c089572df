#pragma once
/// What posterior.nc holds beside the draws themselves.
#include <cstdint>
#include <vector>

#include "inverse/posterior/posterior_fit.hpp"
#include "uq/posterior_file.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel {

/// The groups log_likelihood (every draw), posterior_predictive (the emulator's histories at evenly spaced draws of every chain), observed_data (the recorded
/// means) and prior (draws from the priors of `parameters`, by `seed`). `result` holds draws in the coordinates of fit.posterior.
std::vector<PosteriorGroup> predictive_groups(const PosteriorFit& fit, const Problem& problem, const std::vector<Parameter>& parameters, const SamplerResult& result,
                                              std::uint64_t seed);

}  // namespace calomel
