#pragma once
/// The numbers of a fit as a diagnosis tells them: under the likelihood to the power that its probabilities take the evidences to. On coarse meshes and an
/// emulator it is that much too sure.
#include <cstdint>

#include "inverse/posterior/posterior_fit.hpp"
#include "uq/posterior_moments.hpp"

namespace calomel {

/// Means and deviations of the free parameters, natural units. Errors: those of sampled_moments.
[[nodiscard]] Moments tempered_moments(const LogPosterior& posterior, const LocalMode& mode, std::uint64_t seed);

/// The same of the deviation of a number that the records tell beside a normal prior.
[[nodiscard]] double tempered(double sd, double prior_sd);

/// The moments of a fit, and in the deviations what the mode moved while runs were added, which the draws do not know of. Errors: those of sampled_moments.
[[nodiscard]] Moments parameters_of(const PosteriorFit& fit, std::uint64_t seed);

}  // namespace calomel
