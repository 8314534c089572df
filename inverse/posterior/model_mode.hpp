#pragma once
/// Where a quick model's posterior is greatest, by the model itself.
#include <Eigen/Core>
#include <cstdint>

#include "inverse/posterior/model_posterior.hpp"

namespace calomel {

struct ModelMode {
  Eigen::VectorXd q;            ///< unconstrained coordinates
  Eigen::MatrixXd covariance;   ///< of q: inverse of the curvature there; of a direction without any, the square of `unknown_sd`
  double log_density = 0;
  static constexpr double unknown_sd = 1;
};

/// From the nominal values or, where the density is greater, the best point of a design over the bounds: BFGS with a strong Wolfe line search (Ceres), gradients of the
/// model or by central differences; the curvature by finite differences of the density. Errors: NumericsError where the density is zero everywhere.
[[nodiscard]] ModelMode find_mode(const ModelPosterior& posterior, std::uint64_t seed);

}  // namespace calomel
