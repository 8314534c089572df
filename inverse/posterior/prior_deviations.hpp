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

/// Larger deviations are reported [prior standard deviations]. With some twenty parameters whose priors are right, one fit in twenty has a larger deviation.
constexpr double far_deviation = 3;

}  // namespace calomel
