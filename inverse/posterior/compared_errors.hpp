#pragma once
/// The posterior on one emulator under errors that leave out what this program counts: what an answer owes to its errors, from the same runs.
#include <string>
#include <vector>

#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

/// Names of the forms, as `[posterior] compare` has them.
inline constexpr const char* no_mesh_errors = "no_mesh_errors";
inline constexpr const char* independent_errors = "independent";
const std::vector<std::string>& compared_forms();

/// The posterior of `fit` under a form of errors; its box, emulator and priors remain.
///
/// no_mesh_errors: the same errors without those of the mesh and of numerical noise: the records lie on the finest mesh (beyond = 0), and neither they
/// nor the emulator's mean carry numerical noise.
///
/// independent: at every sample of every record with a band an independent normal error, whose deviation is the band's half width over 1.96, on the model's own
/// times; no covariance, and the nuisances, parameters from index `own` on, held at their nominal values:
///
///   ln L = -1/2 sum_{s,t} ((y_st - f_st(theta)) / sigma_st)^2 + const.
///
/// It is a quadratic form in the emulator's features, which is kept instead of the samples. The form of published posteriors of mercury targets; it counts
/// correlated samples as independent. Errors: InputError where no sample has a band.
[[nodiscard]] LogPosterior compared_posterior(const std::string& form, const PosteriorInputs& in, const PosteriorFit& fit, std::size_t own);

}  // namespace calomel
