#pragma once
/// The residual of a fit and its errors, from which chi-squared and the prior deviations are computed. The fit may be of an emulator or of the model itself.
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "inverse/posterior/error_model.hpp"
#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

struct FitResidual {
  Eigen::VectorXd residual;                   ///< (size) records less prediction, on the grid of the errors
  Eigen::MatrixXd covariance;                 ///< (size, size) of all errors, that of an emulator included
  std::vector<MarginalDirection> directions;  ///< of the nuisance parameters that are marginalised within the covariance
  double chi2 = 0;                            ///< r^T C^-1 r
  std::size_t parameters = 0;                 ///< number of fitted parameters
  double freedom = 0;                         ///< degrees of freedom of the covariance's scale; infinity for a Gaussian
};

/// The residual at the highest mode of a fit, under its likeliest errors. The variance of the emulator includes the noise of one run of the finest mesh.
[[nodiscard]] FitResidual residual_of(const PosteriorFit& fit);

/// The residual of a model without an emulator, from its prediction (size) on the grid of the errors. Errors: NumericsError where the covariance is not
/// positive definite.
[[nodiscard]] FitResidual residual_of(const ErrorModel& errors, const Eigen::VectorXd& prediction, std::size_t parameters);

}  // namespace calomel
