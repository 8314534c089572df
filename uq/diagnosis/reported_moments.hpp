#pragma once
/// Means and standard deviations as a diagnosis reports them: under the likelihood to the power that the verdict's probabilities take evidences to. On coarse
/// meshes and an emulator the likelihood itself is that much too sure.
#include <cstdint>

#include "inverse/posterior/posterior_fit.hpp"
#include "uq/posterior_moments.hpp"

namespace calomel {

/// Means and standard deviations of the free parameters at a mode, natural units. Errors: those of sampled_moments.
[[nodiscard]] Moments tempered_moments(const LogPosterior& posterior, const LocalMode& mode, std::uint64_t seed);

/// The tempered standard deviation of a number with a normal prior of standard deviation `prior_sd`, from its posterior standard deviation `sd`.
[[nodiscard]] double tempered_sd(double sd, double prior_sd);

/// The tempered moments of a fit. To the standard deviations the move of the mode while runs were added is added in quadrature, which the draws do not contain.
/// Errors: those of sampled_moments.
[[nodiscard]] Moments reported_moments(const PosteriorFit& fit, std::uint64_t seed);

}  // namespace calomel
