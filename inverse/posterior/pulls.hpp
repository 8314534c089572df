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

/// One sentence for each that is farther than three deviations from what was said of it, three at most: "the records pull the gain of T2 by +12.9 of its
/// standard deviations (errors.gain_sd), +13 %: ...".
[[nodiscard]] std::vector<std::string> far_pulls(const std::vector<Pull>& pulls, const ErrorOptions& errors);

/// "the gain of T2"
[[nodiscard]] std::string pulled_number(const std::string& term, const std::string& gauge);

}  // namespace calomel
