#pragma once
/// Parameters to the features that a surrogate sees: the box of the bounds scaled to an interval, linearly or in the
/// logarithm of positive parameters.
#include <Eigen/Core>
#include <vector>

#include "base/netcdf_file.hpp"
#include "forward/parameter.hpp"

namespace calomel {

/// How parameters become features.
enum class Coordinates {
  linear,  ///< every parameter once, linear
  log,     ///< every parameter once, logarithmic where its lower bound is positive
  both     ///< every parameter linear, and again logarithmic where its lower bound is positive
};

class InputScaling {
 public:
  /// Features run from `low` to `high` over the bounds of `parameters`.
  InputScaling(const std::vector<Parameter>& parameters, Coordinates coordinates, double low, double high);

  [[nodiscard]] Eigen::Index parameters() const { return bounds_.cols(); }
  [[nodiscard]] Eigen::Index features() const { return Eigen::Index(source_.size()); }
  /// thetas: (n_parameters, n), natural units; result: (features, n).
  [[nodiscard]] Eigen::MatrixXd features(const Eigen::MatrixXd& thetas) const;
  /// Gradient by the features (features) at `theta` turned into one by the parameters (n_parameters).
  [[nodiscard]] Eigen::VectorXd vector_jacobian_product(const Eigen::VectorXd& theta, const Eigen::VectorXd& gradient) const;
  /// log(max / min) of the parameter behind a logarithmic feature, 0 for a linear one.
  [[nodiscard]] double log_ratio(Eigen::Index feature) const;

  void save(NetcdfWriter& file, const std::string& prefix) const;
  static InputScaling load(const NetcdfReader& file, const std::string& prefix);

 private:
  InputScaling() = default;
  Eigen::Matrix2Xd bounds_;  ///< (min and max, n_parameters)
  std::vector<int> source_;  ///< parameter behind each feature
  std::vector<int> log_;     ///< whether the feature is logarithmic
  double low_ = 0, high_ = 1;
};

}  // namespace calomel
