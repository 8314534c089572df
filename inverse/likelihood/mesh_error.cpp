#include "inverse/likelihood/mesh_error.hpp"

#include <Eigen/QR>

#include "base/errors.hpp"

namespace calomel {

MeshError::MeshError(const std::vector<Parameter>& parameters, const Eigen::MatrixXd& theta, const Eigen::MatrixXd& differences, double extrapolation)
    : parameters_(parameters), linear_(theta.cols() >= theta.rows() + 3), differences_(extrapolation * differences) {
  const Eigen::Index pairs = theta.cols();
  expect(pairs >= 2 && differences.cols() == pairs && std::size_t(theta.rows()) == parameters.size(), "a mesh error is learnt from two pairs or more");
  expect(extrapolation >= 1, "the shift goes to the finer mesh or beyond");
  Eigen::MatrixXd design(pairs, linear_ ? theta.rows() + 1 : 1);
  for (Eigen::Index i = 0; i < pairs; ++i) design.row(i) = basis({theta.col(i).data(), std::size_t(theta.rows())}).transpose();
  const Eigen::MatrixXd inverse = design.completeOrthogonalDecomposition().pseudoInverse();  // (basis, pairs)
  coefficients_ = inverse.transpose();
  const Eigen::MatrixXd hat = design * inverse;
  const double freedom = double(pairs) - hat.trace();
  expect(freedom > 0.5, "there are more pairs than the regression has coefficients");
  // What is left, and the scatter of the regression itself: (1 + p / n) / (n - p) of the squares.
  const Eigen::MatrixXd left = differences_ * (Eigen::MatrixXd::Identity(pairs, pairs) - hat);
  spread_ = std::sqrt((1 + hat.trace() / double(pairs)) / freedom) * left;
  if (extrapolation > 1) {
    spread_.conservativeResize(Eigen::NoChange, pairs + 1);
    spread_.col(pairs) = (extrapolation - 1) / extrapolation * differences_.rowwise().mean();
  }
}

Eigen::VectorXd MeshError::basis(std::span<const double> theta) const {
  Eigen::VectorXd b(linear_ ? Eigen::Index(theta.size()) + 1 : 1);
  b[0] = 1;
  for (Eigen::Index k = 1; k < b.size(); ++k) {
    const Parameter& p = parameters_[std::size_t(k - 1)];
    b[k] = 2 * (theta[std::size_t(k - 1)] - p.min) / (p.max - p.min) - 1;
  }
  return b;
}

Eigen::VectorXd MeshError::shift(std::span<const double> theta) const { return differences_ * (coefficients_ * basis(theta)); }

}  // namespace calomel
