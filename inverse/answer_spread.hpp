#pragma once
/// Parts of MAP's artefacts.
#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/options.hpp"
#include "inverse/identify.hpp"

namespace calomel {

/// What a calibration finds for the records that a pair of meshes which it does not know would have given.
struct FoundPair {
  std::vector<double> theta, found;
  double squares = 0;  ///< squared distance of the two by the covariance of the answer
};

/// Rows of numbers; null for those that are not finite.
Json matrix_json(const Eigen::MatrixXd& m);
/// name, value, low, high and relative_sd of each.
Json combinations_json(std::span<const Combination> combinations);

}  // namespace calomel
