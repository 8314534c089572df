#include "inverse/refined_model.hpp"

#include <algorithm>

#include "base/errors.hpp"

namespace calomel {

namespace {

/// Errors of the base; a point where it fails counts as one where it knows nothing: contract failure, such points are not added.
Eigen::MatrixXd errors_of(const ForwardModel& base, const Eigen::MatrixXd& theta, const Eigen::MatrixXd& truth) {
  const Eigen::MatrixXd predicted = base.means(theta, 1).cast<double>();
  expect(predicted.allFinite() && truth.allFinite(), "runs are added where both models have values");
  return truth - predicted;
}

}  // namespace

RefinedModel::RefinedModel(const ForwardModel& base, const Variance& variance, const Eigen::MatrixXd& theta, const Eigen::MatrixXd& truth)
    : base_(base), variance_(variance), errors_(errors_of(base, theta, truth)), kriging_(base.shape().parameters, theta, errors_) {
  double promised = 0;
  if (variance_)
    for (Eigen::Index i = 0; i < theta.cols(); ++i) promised += variance_({theta.col(i).data(), std::size_t(theta.rows())}).sum();
  if (promised > 0) ratio_ = errors_.squaredNorm() / promised;
}

Prediction RefinedModel::evaluate(std::span<const double> theta) const {
  Prediction p = base_.evaluate(theta);
  if (!p.ok) return p;
  Eigen::Map<Eigen::VectorXd>(p.mean.data(), Eigen::Index(p.mean.size())) += errors_ * kriging_.weights(theta);
  return p;
}

Eigen::MatrixXf RefinedModel::means(const Eigen::MatrixXd& thetas, int threads) const {
  Eigen::MatrixXf y = base_.means(thetas, threads);
  for (Eigen::Index i = 0; i < y.cols(); ++i)
    y.col(i) += (errors_ * kriging_.weights({thetas.col(i).data(), std::size_t(thetas.rows())})).cast<float>();
  return y;
}

HistoryBasis RefinedModel::basis() const {
  HistoryBasis own = base_.basis();
  return own.empty() ? own : own.with(errors_);
}

Eigen::MatrixXf RefinedModel::coefficients(const Eigen::MatrixXd& thetas) const {
  const Eigen::MatrixXf own = base_.coefficients(thetas);
  Eigen::MatrixXf all(own.rows() + kriging_.size(), own.cols());
  all << own, kriging_.weights_at(thetas).cast<float>();
  return all;
}

Eigen::VectorXd RefinedModel::pull_back(std::span<const double> theta, std::span<const double> weights) const {
  return base_.pull_back(theta, weights) + kriging_.slope(theta, errors_.transpose() * Eigen::Map<const Eigen::VectorXd>(weights.data(), Eigen::Index(weights.size())));
}

Eigen::VectorXd RefinedModel::error_variance(std::span<const double> theta) const {
  return variance_(theta) * (std::max(1.0, ratio_) * std::min(1.0, kriging_.variance_factor(theta)));
}

}  // namespace calomel
