#pragma once
/// Numbers that a diagnosis takes from a fit: chi-squared, misfits, and the case's own parameters.
#include <span>
#include <vector>

#include "base/linear_algebra.hpp"
#include "uq/diagnosis/alternative.hpp"
#include "uq/diagnosis/diagnosis_inputs.hpp"
#include "uq/posterior_moments.hpp"

namespace calomel {

/// A history as it is kept, and as it is computed with.
[[nodiscard]] inline std::vector<double> kept(const Eigen::VectorXd& v) { return {v.begin(), v.end()}; }
[[nodiscard]] inline Eigen::Map<const Eigen::VectorXd> values_of(const std::vector<double>& v) { return {v.data(), Eigen::Index(v.size())}; }

/// Errors of a fit at its mode without any discrepancy: those of the records and of its emulator.
[[nodiscard]] Cholesky plain_errors(const PosteriorFit& fit, const LogPosterior& posterior, const LocalMode& mode, const ErrorModel& errors);

/// Chi-squared of a fit at its mode under such errors.
[[nodiscard]] double plain_chi2(const Cholesky& plain, const ErrorModel& errors, const PosteriorFit& fit, const LocalMode& mode);

/// |history - record| / |record| in the compared band, mean over the gauges of the fit's records. history: (values of the model).
[[nodiscard]] double misfit_of_history(const PosteriorFit& fit, const Eigen::VectorXd& history);

/// The same of each observation; NaN where the history is empty.
[[nodiscard]] std::vector<double> misfits_by_gauge(const PosteriorFit& fit, const std::vector<double>& history);

/// Distances of the case's own parameters from the middle of their priors, in standard deviations; 0 of a parameter without a handbook value.
[[nodiscard]] std::vector<double> prior_deviations(const DiagnosisInputs& in, std::span<const double> theta);

/// Posterior means and standard deviations of those of the case's own parameters that are free.
[[nodiscard]] std::vector<Estimate> own_parameters(const DiagnosisInputs& in, const LogPosterior& posterior, const Moments& moments);

[[nodiscard]] double root_mean_square(const std::vector<double>& x);

}  // namespace calomel
