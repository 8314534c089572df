/// Apart from the other decompositions, because it takes longer to compile than all of them.
#include <Eigen/QR>
#include <Eigen/SVD>

#include "base/linear_algebra.hpp"

namespace calomel {

Eigen::MatrixXd orthogonal_factor(const Eigen::MatrixXd& a) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(a);
  Eigen::MatrixXd q = qr.householderQ();
  for (Eigen::Index k = 0; k < a.cols(); ++k)
    if (qr.matrixQR()(k, k) < 0) q.col(k) *= -1;
  return q;
}

Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) { return Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(a).solve(b); }

SingularValues singular_values(const Eigen::MatrixXd& a) {
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.singularValues(), svd.matrixU()};
}

}  // namespace calomel
