#pragma once
/// What a fit leaves of the records, and the errors that it is held against: what chi-squared and pulls ask, whether an emulator was fitted or the model
/// itself.
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "inverse/posterior/error_model.hpp"
#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

struct FitResidual {
  Eigen::VectorXd residual;                   ///< (size) records less prediction, on the grid of the errors
  Eigen::MatrixXd covariance;                 ///< (size, size) of all errors, that of an emulator included
  std::vector<MarginalDirection> directions;  ///< of the numbers that are marginalised within it
  double chi2 = 0;                            ///< r^T C^-1 r
  std::size_t parameters = 0;                 ///< that were fitted
  double freedom = 0;                         ///< of the covariance's scale; infinity for a Gaussian
};

/// Of the highest mode of a fit, under its likeliest errors; the noise of one run of the finest mesh counts with the emulator's variance.
[[nodiscard]] FitResidual residual_of(const PosteriorFit& fit);

/// Of a model without an emulator, from its prediction on the grid of the errors, (size). Errors: NumericsError where the covariance is not positive definite.
[[nodiscard]] FitResidual residual_of(const ErrorModel& errors, const Eigen::VectorXd& prediction, std::size_t parameters);

}  // namespace calomel
