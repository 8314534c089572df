#pragma once
/// Regions that hold a share of a posterior's draws.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "uq/draws.hpp"

namespace calomel {

/// Central intervals of some quantities, and ellipsoids (x - mean)' covariance^-1 (x - mean) <= radius^2 that hold the same share of the draws.
struct Regions {
  std::vector<std::string> names;
  Eigen::VectorXd mean;        ///< (names) [unit of each]
  Eigen::MatrixXd covariance;  ///< (names, names)
  struct Share {
    double share = 0;          ///< share of the draws
    std::vector<double> low;   ///< (names), the quantile (1 - share)/2
    std::vector<double> high;  ///< (names), the quantile (1 + share)/2
    double square_radius = 0;  ///< quantile `share` of the draws' squared Mahalanobis distances
  };
  std::vector<Share> shares;  ///< 50 and 90 %; empty, as is the covariance, for a single draw
};

/// The regions of the quantities `names`; names that `draws` does not have are left out. Errors: ContractFailure where no name is left, or there is no draw.
[[nodiscard]] Regions regions(const Draws& draws, const std::vector<std::string>& names);

}  // namespace calomel
