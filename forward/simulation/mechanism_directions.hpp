#pragma once
/// How physics that a model leaves out would change its values.
#include <Eigen/Core>
#include <string>
#include <vector>

namespace calomel {

/// Of one mechanism, or of another error that acts in its place, to first order.
struct MechanismDirections {
  std::string name;               ///< of the mechanism, or gauge_gains
  std::vector<std::string> keys;  ///< its numbers; 1/KEY for one that is infinite where it is off
  std::vector<double> off;        ///< their values that switch it off
  Eigen::MatrixXd directions;     ///< (values of the model, keys): change of the model's values per unit of the key
  bool like_the_mesh = false;     ///< damping, lag: a coarse mesh does the same
};

}  // namespace calomel
