#include "uq/diagnosis/first_order.hpp"

#include "base/linear_algebra.hpp"

namespace calomel {

FirstOrder first_order(const LogPosterior& posterior, const LocalMode& mode, const Decimation& grid, const AddedDirections& directions) {
  const Eigen::Index n = directions.by_number.cols();
  expect(directions.prior_sd.size() == n && (directions.prior_sd.array() > 0).all(), "every number has a prior");
  const Eigen::VectorXd r = posterior.whitened_residual(mode.at);
  const Eigen::MatrixXd j = posterior.whiten(posterior.jacobian(mode.at), mode.at);
  // In units of the priors, so that P is 1.
  const Eigen::MatrixXd d = posterior.whiten(grid.apply(directions.by_number), mode.at) * directions.prior_sd.asDiagonal();
  const Eigen::MatrixXd jd = j.transpose() * d;
  Eigen::MatrixXd a = d.transpose() * d - jd.transpose() * mode.covariance * jd;
  a = 0.5 * (a + a.transpose()).eval();
  // What the fit's coordinates do as well is left with nothing, never with less.
  SymmetricEigen eigen = symmetric_eigen(a);
  const Eigen::VectorXd values = eigen.values.cwiseMax(0.0).array() + 1;
  const Eigen::VectorXd b = eigen.vectors.transpose() * (d.transpose() * r);
  FirstOrder out;
  out.log_bayes_factor = 0.5 * (b.array().square() / values.array() - values.array().log()).sum();
  const Eigen::VectorXd mu = eigen.vectors * (b.array() / values.array()).matrix();
  const Eigen::MatrixXd covariance = eigen.vectors * values.cwiseInverse().asDiagonal() * eigen.vectors.transpose();
  out.value = directions.prior_sd.asDiagonal() * mu;
  out.sd = directions.prior_sd.cwiseProduct(covariance.diagonal().cwiseSqrt());
  out.shift = -mode.covariance * (jd * mu);
  return out;
}

}  // namespace calomel
