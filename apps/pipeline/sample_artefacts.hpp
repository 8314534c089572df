#pragma once
/// What posterior.json reports of the emulator's hyperparameters, its refinements, regions of the draws, and posteriors under other errors.
#include "base/options.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/drawn_noise_density.hpp"
#include "uq/refinement.hpp"
#include "uq/regions.hpp"
#include "uq/sampler/modes.hpp"

namespace calomel {

/// [{theta: {name: value}, share}], the greatest share first: by Laplace's approximation.
Json modes_json(const LogDensity& density, const std::vector<LaplaceMode>& modes);
/// {draws: 0, reason}: the estimate alone was taken.
Json hyperparameters_json(const std::string& why_none);
/// {draws, noise_ratio: [draw][level], noise_scale: [draw], weights: [draw], effective_draws, sd_ratio: {name: ratio}, sd_ratio_alike: {name: ratio},
/// mean_shift_sds: {name: shift}, plug_in_draws, sentence}.
Json hyperparameters_json(const std::vector<DrawnNoise>& drawn, const NoiseInflation& inflation, const std::vector<std::string>& names);
/// {made, most, ended, checks: [{p_value, score, sentence, runs, box_drawn_in}]} of the checks that did not hold.
Json refinement_json(const RefinedFit& fit, int most);
/// {parameters, mean, covariance, shares: [{share, low, high, square_radius}]}.
Json regions_json(const Regions& regions);
/// {what, parameters, converged, message, regions} of a posterior under other errors.
Json compared_json(const std::string& what, const Convergence& convergence, const Regions& regions);

}  // namespace calomel
