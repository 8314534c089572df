#pragma once
/// The density of whitened residuals: normal, or Student's t where the errors' scale was estimated from few squares.
#include <algorithm>
#include <cmath>
#include <numbers>

namespace calomel {

/// log density at residual 0 of so many values with unit covariance. `freedom` of Student's t; infinity: normal.
inline double log_norm_of_errors(double freedom, double values) {
  if (std::isinf(freedom)) return -0.5 * values * std::log(2 * std::numbers::pi);
  return std::lgamma((freedom + values) / 2) - std::lgamma(freedom / 2) - 0.5 * values * std::log(freedom * std::numbers::pi);
}

/// -log density at this chi-squared over that of residual 0.
inline double penalty_of_errors(double chi2, double freedom, double values) {
  chi2 = std::max(0.0, chi2);
  return std::isinf(freedom) ? 0.5 * chi2 : 0.5 * (freedom + values) * std::log1p(chi2 / freedom);
}

}  // namespace calomel
