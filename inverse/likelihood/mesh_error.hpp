#pragma once
/// The difference between the working mesh and a finer one, from pairs of runs: a shift of low order in the parameters and its spread.
#include <Eigen/Core>
#include <span>
#include <vector>

#include "forward/parameter.hpp"

namespace calomel {

/// fine - coarse as a function of the parameters: shift = differences * weights(theta), a linear regression on the scaled parameters where there are
/// pairs enough, their mean otherwise. `spread` (values, k): its columns' outer products add up to the covariance of what the regression leaves, as for
/// one more pair at an unknown place.
class MeshError {
 public:
  MeshError() = default;
  /// theta: (n_parameters, pairs); differences: (values, pairs), fine - coarse, in the data's unit. `extrapolation`: the shift to the limit of a vanishing
  /// element over fine - coarse, 2 where the error falls with the first power of the size and the finer mesh has half of it, 1 to stay at the finer mesh.
  /// What lies beyond the finer mesh adds (extrapolation - 1) times the shift itself to the spread as one column: its size is as sure as its law.
  /// Linear in the parameters from n_parameters + 3 pairs, constant below; at least two. Errors: contract failure for other shapes.
  MeshError(const std::vector<Parameter>& parameters, const Eigen::MatrixXd& theta, const Eigen::MatrixXd& differences, double extrapolation = 1);

  [[nodiscard]] bool empty() const { return differences_.size() == 0; }
  /// To be added to the working mesh's history, (values).
  [[nodiscard]] Eigen::VectorXd shift(std::span<const double> theta) const;
  [[nodiscard]] const Eigen::MatrixXd& spread() const { return spread_; }

 private:
  [[nodiscard]] Eigen::VectorXd basis(std::span<const double> theta) const;
  std::vector<Parameter> parameters_;
  bool linear_ = false;
  Eigen::MatrixXd differences_;   ///< (values, pairs)
  Eigen::MatrixXd coefficients_;  ///< (pairs, basis): weights(theta) = coefficients * basis(theta)
  Eigen::MatrixXd spread_;
};

}  // namespace calomel
