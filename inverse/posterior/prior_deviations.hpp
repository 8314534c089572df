#pragma once
/// Estimates of the nuisance parameters that the posterior marginalises: gains, zeros and places of gauges, the energy of the pulse, the clock.
#include <string>
#include <vector>

#include "inverse/posterior/fit_residual.hpp"

namespace calomel {

/// The estimate of one nuisance parameter, in prior standard deviations.
struct PriorDeviation {
  std::string term, gauge;  ///< MarginalDirection's
  double deviation = 0;     ///< posterior mean less prior mean
  double sd = 1;            ///< posterior standard deviation; 1 where the records do not determine the parameter
};

/// Estimates at the fitted parameters, the largest deviation first. With d the change of the records by one prior standard deviation of the parameter, C the
/// covariance of all errors and r the residual, the mean is d^T C^-1 r and the variance 1 - d^T C^-1 d.
[[nodiscard]] std::vector<PriorDeviation> prior_deviations(const FitResidual& left);

/// One sentence for each of the at most three largest deviations beyond three prior standard deviations.
[[nodiscard]] std::vector<std::string> far_deviations(const std::vector<PriorDeviation>& deviations, const ErrorOptions& errors);

/// "the gain of T2"
[[nodiscard]] std::string nuisance_name(const std::string& term, const std::string& gauge);

}  // namespace calomel
