#pragma once
/// Regions that hold a share of a posterior's draws.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "uq/draws.hpp"

namespace calomel {

/// Of the quantities named: central intervals, and ellipsoids (x - mean)' covariance^-1 (x - mean) <= radius^2 that hold as great a share of the draws.
struct Regions {
  std::vector<std::string> names;
  Eigen::VectorXd mean;        ///< (names) [unit of each]
  Eigen::MatrixXd covariance;  ///< (names, names)
  struct Share {
    double share = 0;               ///< of the draws
    std::vector<double> low, high;  ///< (names), quantiles (1 - share)/2 and (1 + share)/2
    double square_radius = 0;       ///< quantile `share` of the draws' squared Mahalanobis distances
  };
  std::vector<Share> shares;  ///< 50 and 90 %; none of a single draw, which has no covariance either
};

/// Names that `draws` does not have are left out. Errors: ContractFailure where none is left, or there is no draw.
[[nodiscard]] Regions regions(const Draws& draws, const std::vector<std::string>& names);

}  // namespace calomel
