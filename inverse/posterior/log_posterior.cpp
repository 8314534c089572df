#include "inverse/posterior/log_posterior.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/linear_algebra.hpp"

namespace calomel {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double edge = 1e-6;
const std::string beyond_name = "beyond";

}  // namespace

LogPosterior::LogPosterior(EmulatorBox box, MultilevelRegression emulator, const Eigen::MatrixXd& coefficients, const ErrorModel& errors,
                           const Eigen::MatrixXd& noise, std::vector<Prior> priors, BeyondPrior beyond)
    : box_(std::move(box)), emulator_(std::move(emulator)), priors_(std::move(priors)), beyond_(beyond), has_beyond_(emulator_.levels() > 1 && beyond.sd > 0),
      freedom_(errors.freedom()) {
  const auto n = Eigen::Index(errors.grid().size());
  expect(coefficients.rows() == n && noise.rows() == n && noise.cols() == n && priors_.size() == std::size_t(box_.size()),
         "emulator, noise and priors belong to the records and the box");
  const Cholesky factor(errors.covariance());
  if (!factor.positive_definite()) throw NumericsError("the covariance of the records' errors is not positive definite");
  const Eigen::MatrixXd half = factor.solve_lower(noise), whitened = factor.solve_lower(Eigen::MatrixXd(half.transpose()));
  const SymmetricEigen eigen = symmetric_eigen(0.5 * (whitened + whitened.transpose()));
  ratio_ = eigen.values.cwiseMax(0.0);
  whitener_ = eigen.vectors.transpose() * factor.solve_lower(Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n)));
  data_ = whitener_ * errors.data();
  coefficients_ = whitener_ * coefficients;
  const double half_log_det = factor.half_log_determinant(), p = double(n);
  log_norm_ = std::isinf(freedom_) ? -0.5 * p * std::log(2 * std::numbers::pi) - half_log_det
                                   : std::lgamma((freedom_ + p) / 2) - std::lgamma(freedom_ / 2) - 0.5 * p * std::log(freedom_ * std::numbers::pi) - half_log_det;
}

std::vector<std::string> LogPosterior::names() const {
  std::vector<std::string> names;
  for (const auto& p : box_.parameters()) names.push_back(p.name);
  if (has_beyond_) names.push_back(beyond_name);
  return names;
}

LogPosterior::Point LogPosterior::point(const Eigen::VectorXd& q) const {
  Point p;
  p.u = (0.5 * q.head(box_.size()).array()).tanh();  // 2 logistic(q) - 1
  p.beyond = has_beyond_ ? q[box_.size()] : emulator_.levels() > 1 ? beyond_.mean : 0;
  p.theta = box_.theta(p.u);
  return p;
}

Eigen::VectorXd LogPosterior::q(std::span<const double> theta, double beyond) const {
  Eigen::VectorXd q(dimension());
  const Eigen::VectorXd u = box_.u(theta).cwiseMax(-1 + edge).cwiseMin(1 - edge);
  q.head(box_.size()) = 2 * u.array().atanh();
  if (has_beyond_) q[box_.size()] = beyond;
  return q;
}

LogPosterior::Density LogPosterior::density(const Point& at) const {
  Density out;
  const Eigen::Index d = box_.size(), n = dimension();
  const Eigen::VectorXd x = emulator_.features(at.u, at.beyond), hx = emulator_.inverse() * x;
  const Eigen::MatrixXd dx = emulator_.features_slope(at.u, at.beyond).leftCols(n);
  const double v = x.dot(hx);
  const Eigen::VectorXd r = data_ - coefficients_ * x;
  const Eigen::ArrayXd spread = 1 + v * ratio_.array();
  const Eigen::ArrayXd weighed = r.array() / spread;
  out.variance = v, out.chi2 = (r.array() * weighed).sum();
  const double log_spread = spread.log().sum();
  double weight = 1;  // d log L / d(-chi2 / 2)
  if (std::isinf(freedom_)) {
    out.log_likelihood = log_norm_ - 0.5 * log_spread - 0.5 * out.chi2;
  } else {
    out.log_likelihood = log_norm_ - 0.5 * log_spread - 0.5 * (freedom_ + double(values())) * std::log1p(out.chi2 / freedom_);
    weight = (freedom_ + double(values())) / (freedom_ + out.chi2);
  }
  const double by_v = 0.5 * (weight * (weighed.square() * ratio_.array()).sum() - (ratio_.array() / spread).sum());
  out.likelihood_gradient = dx.transpose() * (weight * (coefficients_.transpose() * weighed.matrix()) + 2 * by_v * hx);

  out.prior_gradient = Eigen::VectorXd::Zero(n);
  const Eigen::VectorXd by_u = box_.slope(at.u);
  for (Eigen::Index k = 0; k < d; ++k) {
    const double t = at.theta[std::size_t(k)];
    out.log_prior += priors_[std::size_t(k)].log_density(t);
    out.prior_gradient[k] = priors_[std::size_t(k)].log_density_slope(t) * by_u[k];
  }
  if (has_beyond_) {
    const double z = (at.beyond - beyond_.mean) / beyond_.sd;
    out.log_prior += -0.5 * z * z - std::log(beyond_.sd * std::sqrt(2 * std::numbers::pi));
    out.prior_gradient[d] = -z / beyond_.sd;
  }
  return out;
}

double LogPosterior::transform(const Eigen::VectorXd& q, bool jacobian, Eigen::VectorXd* gradient) const {
  const Point at = point(q);
  const Density density = this->density(at);
  double value = density.log_posterior();
  if (!std::isfinite(value)) {
    if (gradient) gradient->setZero(dimension());
    return -infinity;
  }
  Eigen::VectorXd by_u = density.likelihood_gradient + density.prior_gradient;
  const Eigen::VectorXd slope = box_.slope(at.u);
  for (Eigen::Index k = 0; k < box_.size(); ++k) {
    const Parameter& p = box_.parameters()[std::size_t(k)];
    const bool log_coordinate = p.min > 0;
    // Density by u: log |d theta / d u| = log theta + const for a logarithmic coordinate; the mode of a lognormal prior is that of the logarithm.
    if (jacobian ? log_coordinate : p.prior == "lognormal") {
      value += std::log(at.theta[std::size_t(k)]);
      by_u[k] += slope[k] / at.theta[std::size_t(k)];
    }
    if (jacobian) {  // log |d u / d q| = log((1 - u^2) / 2), and the half width
      value += std::log(0.5 * (1 - at.u[k] * at.u[k])) + std::log(slope[k] / (log_coordinate ? at.theta[std::size_t(k)] : 1));
      by_u[k] += -2 * at.u[k] / (1 - at.u[k] * at.u[k]);
    }
  }
  if (gradient) {
    *gradient = by_u;
    gradient->head(box_.size()).array() *= 0.5 * (1 - at.u.array().square());
  }
  return value;
}

double LogPosterior::log_density(const Eigen::VectorXd& q, Eigen::VectorXd* gradient) const { return transform(q, true, gradient); }
double LogPosterior::mode_density(const Eigen::VectorXd& q, Eigen::VectorXd* gradient) const { return transform(q, false, gradient); }

Eigen::VectorXd LogPosterior::whitened_residual(const Point& at) const {
  const Eigen::VectorXd x = emulator_.features(at.u, at.beyond);
  return (data_ - coefficients_ * x).array() / (1 + emulator_.variance(x) * ratio_.array()).sqrt();
}

Eigen::MatrixXd LogPosterior::whiten(const Eigen::MatrixXd& directions, double variance) const {
  return (1 + variance * ratio_.array()).rsqrt().matrix().asDiagonal() * (whitener_ * directions);
}

}  // namespace calomel
