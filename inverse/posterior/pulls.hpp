#pragma once
/// What the records say of the numbers that the posterior marginalises: gains, zeros and places of gauges, the pulse's energy, the clock.
#include <string>
#include <vector>

#include "inverse/posterior/fit_residual.hpp"

namespace calomel {

struct Pull {
  std::string term, gauge;  ///< MarginalDirection's
  double pull = 0;          ///< mean by the records, in standard deviations of what was known of it
  double sd = 1;            ///< its standard deviation by the records, over that; 1: they say nothing of it
};

/// With the parameters where they are: with d what one standard deviation of the number does, C the covariance of all errors and r the residual, the mean is
/// d^T C^-1 r and the variance 1 - d^T C^-1 d. Farthest first.
[[nodiscard]] std::vector<Pull> pulls(const FitResidual& left);

/// Pulls beyond it are reported. Where some twenty numbers are as their priors have them, one in twenty fits has such a pull.
constexpr double far_pull = 3;

}  // namespace calomel
