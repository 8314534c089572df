#include "inverse/posterior/log_posterior.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/linear_algebra.hpp"
#include "base/log_sum.hpp"
#include "base/not_finite.hpp"
#include "inverse/posterior/error_density.hpp"

namespace calomel {

namespace {

constexpr double inset = 1e-6;  ///< a search begins at least this far inside its box [half widths]
const std::string beyond_name = "beyond";

std::vector<RecordErrors> record_errors(const std::vector<WeightedErrors>& errors) {
  std::vector<RecordErrors> out;
  for (const auto& [model, log_weight, scale] : errors) out.push_back({model.covariance(), model.data(), model.freedom(), log_weight});
  return out;
}

}  // namespace

LogPosterior::LogPosterior(EmulatorBox box, MultilevelRegression emulator, const Eigen::MatrixXd& coefficients, const std::vector<WeightedErrors>& errors,
                           const Eigen::MatrixXd& noise, std::vector<Prior> priors, BeyondPrior beyond)
    : LogPosterior(std::move(box), std::move(emulator), coefficients, record_errors(errors), noise, std::move(priors), beyond) {}

LogPosterior::LogPosterior(EmulatorBox box, MultilevelRegression emulator, const Eigen::MatrixXd& coefficients, const std::vector<RecordErrors>& errors,
                           const Eigen::MatrixXd& noise, std::vector<Prior> priors, BeyondPrior beyond)
    : box_(std::move(box)),
      emulator_(std::move(emulator)),
      priors_(std::move(priors)),
      beyond_(beyond),
      has_beyond_(emulator_.levels() > 1 && beyond.sd > 0),
      free_(std::size_t(box_.size())),
      held_(Eigen::VectorXd::Zero(box_.size())),
      coefficients_(coefficients) {
  const Eigen::Index n = coefficients.rows();
  expect(!errors.empty() && noise.rows() == n && noise.cols() == n && priors_.size() == std::size_t(box_.size()),
         "emulator, noise and priors belong to the records and the box");
  std::iota(free_.begin(), free_.end(), Eigen::Index(0));
  for (const auto& e : errors) {
    expect(e.data.size() == n && e.covariance.rows() == n, "all hypotheses are about the same records");
    const Cholesky factor(e.covariance);
    if (!factor.positive_definite()) throw NumericsError("the covariance of the records' errors is not positive definite");
    Hypothesis h{.log_weight = e.log_weight,
                 .freedom = e.freedom,
                 .log_norm = 0,
                 .whitener = factor.solve_lower(Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n))),
                 .data = {},
                 .coefficients = {},
                 .ratio = Eigen::VectorXd::Zero(n)};
    if (!noise.isZero(0)) {
      const Eigen::MatrixXd half = factor.solve_lower(noise), whitened = factor.solve_lower(Eigen::MatrixXd(half.transpose()));
      const SymmetricEigen eigen = symmetric_eigen(0.5 * (whitened + whitened.transpose()));
      h.ratio = eigen.values.cwiseMax(0.0);
      h.whitener = eigen.vectors.transpose() * h.whitener;
    }
    h.data = h.whitener * e.data;
    h.coefficients = h.whitener * coefficients;
    h.log_norm = log_norm_of_errors(h.freedom, double(n)) - factor.half_log_determinant();
    hypotheses_.push_back(std::move(h));
  }
}

LogPosterior LogPosterior::to_the_power(double power) const {
  expect(power > 0, "the power of a likelihood is above 0");
  LogPosterior out = *this;
  out.power_ = power;
  return out;
}

LogPosterior LogPosterior::part(const std::vector<std::size_t>& hypotheses) const {
  LogPosterior out = *this;
  out.hypotheses_.clear();
  double weight = 0;
  for (const auto j : hypotheses) weight += std::exp(hypotheses_[j].log_weight);
  for (const auto j : hypotheses) {
    out.hypotheses_.push_back(hypotheses_[j]);
    out.hypotheses_.back().log_weight -= std::log(weight);
  }
  return out;
}

LogPosterior LogPosterior::held(const std::vector<std::pair<Eigen::Index, double>>& values) const {
  LogPosterior out = *this;
  for (const auto& [k, value] : values) {
    std::vector<double> theta = box_.theta(held_);
    theta[std::size_t(k)] = value;
    out.held_[k] = box_.u(theta)[k];
    out.held_values_.emplace_back(std::size_t(k), value);
    std::erase(out.free_, k);
  }
  return out;
}

std::vector<double> LogPosterior::theta_at(const Eigen::VectorXd& u) const {
  std::vector<double> theta = box_.theta(u);
  for (const auto& [k, value] : held_values_) theta[k] = value;
  return theta;
}

std::vector<std::string> LogPosterior::names() const {
  std::vector<std::string> names;
  for (const auto k : free_) names.push_back(box_.parameters()[std::size_t(k)].name);
  if (has_beyond_) names.push_back(beyond_name);
  return names;
}

LogPosterior::Point LogPosterior::point(const Eigen::VectorXd& q) const {
  Point p{.u = held_, .beyond = has_beyond_ ? q[q.size() - 1] : emulator_.levels() > 1 ? beyond_.mean : 0, .theta = {}};
  p.u(free_) = (0.5 * q.head(Eigen::Index(free_.size())).array()).tanh().matrix();  // 2 logistic(q) - 1
  p.theta = theta_at(p.u);
  return p;
}

Eigen::VectorXd LogPosterior::q(std::span<const double> theta, double beyond) const {
  Eigen::VectorXd q(dimension());
  const Eigen::VectorXd u = box_.u(theta).cwiseMax(-1 + inset).cwiseMin(1 - inset);
  q.head(Eigen::Index(free_.size())) = 2 * u(free_).array().atanh();
  if (has_beyond_) q[q.size() - 1] = beyond;
  return q;
}

LogPosterior::Point LogPosterior::moved(const Point& from, Eigen::Index k, double by) const {
  Point p = from;
  if (k < Eigen::Index(free_.size())) {
    p.u[free_[std::size_t(k)]] += by;
    p.theta = theta_at(p.u);
  } else {
    p.beyond += by;
  }
  return p;
}

LogPosterior::Likelihood LogPosterior::likelihood(const Hypothesis& h, const Eigen::VectorXd& residual, double variance) const {
  Likelihood l{.value = 0, .chi2 = 0, .weight = 1, .inflation = 1 + variance * h.ratio.array(), .weighed = {}};
  l.weighed = residual.array() / l.inflation;
  l.chi2 = (residual.array() * l.weighed).sum();
  const double p = double(residual.size()), log_inflation = l.inflation.log().sum();
  l.value = h.log_norm - 0.5 * log_inflation - penalty_of_errors(l.chi2, h.freedom, p);
  if (!std::isinf(h.freedom)) l.weight = (h.freedom + p) / (h.freedom + l.chi2);
  return l;
}

LogPosterior::Density LogPosterior::density(const Point& at, bool with_gradients) const {
  Density out;
  const auto f = Eigen::Index(free_.size()), n = dimension();
  const Eigen::VectorXd x = emulator_.features(at.u, at.beyond), hx = emulator_.inverse() * x;
  Eigen::MatrixXd dx;
  if (with_gradients) {
    const Eigen::MatrixXd all = emulator_.features_slope(at.u, at.beyond);
    dx.resize(all.rows(), n);
    dx.leftCols(f) = all(Eigen::all, free_);
    if (has_beyond_) dx.col(f) = all.col(all.cols() - 1);
  }
  out.variance = x.dot(hx);

  std::vector<Eigen::VectorXd> gradients;
  std::vector<double>& logs = out.log_terms;
  std::size_t best = 0;
  double chi2 = 0;
  for (const auto& h : hypotheses_) {
    const Likelihood l = likelihood(h, h.data - h.coefficients * x, out.variance);
    logs.push_back(l.value + h.log_weight);
    if (with_gradients) {
      const double by_v = 0.5 * (l.weight * (l.weighed.square() * h.ratio.array()).sum() - (h.ratio.array() / l.inflation).sum());
      gradients.push_back(dx.transpose() * (l.weight * (h.coefficients.transpose() * l.weighed.matrix()) + 2 * by_v * hx));
    }
    if (logs.size() == 1 || logs.back() > logs[best]) {
      best = logs.size() - 1;
      chi2 = l.chi2;
    }
  }
  out.log_likelihood = log_sum(logs);
  out.chi2 = chi2;
  out.weights = shares(logs);
  out.likelihood_gradient = Eigen::VectorXd::Zero(n);
  for (std::size_t j = 0; j < gradients.size(); ++j) out.likelihood_gradient += out.weights[j] * gradients[j];

  out.prior_gradient = Eigen::VectorXd::Zero(n);
  const Eigen::VectorXd by_u = box_.derivative(at.u);
  for (Eigen::Index i = 0; i < f; ++i) {
    const Eigen::Index k = free_[std::size_t(i)];
    const double t = at.theta[std::size_t(k)];
    out.log_prior += priors_[std::size_t(k)].log_density(t);
    out.prior_gradient[i] = priors_[std::size_t(k)].log_density_slope(t) * by_u[k];
  }
  if (has_beyond_) {
    const double z = (at.beyond - beyond_.mean) / beyond_.sd;
    out.log_prior += -0.5 * z * z - std::log(beyond_.sd * std::sqrt(2 * std::numbers::pi));
    out.prior_gradient[f] = -z / beyond_.sd;
  }
  return out;
}

double LogPosterior::log_likelihood_of(const Eigen::VectorXd& prediction, double variance) const {
  std::vector<double> logs;
  for (const auto& h : hypotheses_) logs.push_back(h.log_weight + likelihood(h, h.data - h.whitener * prediction, variance).value);
  return log_sum(logs);
}

double LogPosterior::transform(const Eigen::VectorXd& q, bool jacobian, Eigen::VectorXd* gradient) const {
  const Point at = point(q);
  const Density density = this->density(at, gradient != nullptr);
  double value = power_ * density.log_likelihood + density.log_prior;
  if (!std::isfinite(value)) {
    if (gradient) gradient->setZero(dimension());
    return -infinity;
  }
  Eigen::VectorXd by_u = power_ * density.likelihood_gradient + density.prior_gradient;
  const Eigen::VectorXd slope = box_.derivative(at.u);
  for (Eigen::Index i = 0; i < Eigen::Index(free_.size()); ++i) {
    const Eigen::Index k = free_[std::size_t(i)];
    const Parameter& p = box_.parameters()[std::size_t(k)];
    const double u = at.u[k], theta = at.theta[std::size_t(k)];
    const bool log_coordinate = p.logarithmic();
    // Density by u: log |d theta / d u| = log theta + const for a logarithmic coordinate; the mode of a lognormal prior is that of the logarithm.
    if (jacobian ? log_coordinate : p.prior == "lognormal") {
      value += std::log(theta);
      by_u[i] += slope[k] / theta;
    }
    if (jacobian) {  // log |d u / d q| = log((1 - u^2) / 2), and the half width
      value += std::log(0.5 * (1 - u * u)) + std::log(slope[k] / (log_coordinate ? theta : 1));
      by_u[i] += -2 * u / (1 - u * u);
    }
    if (gradient) by_u[i] *= 0.5 * (1 - u * u);
  }
  if (gradient) *gradient = by_u;
  return value;
}

double LogPosterior::log_density(const Eigen::VectorXd& q, Eigen::VectorXd* gradient) const { return transform(q, true, gradient); }
double LogPosterior::mode_density(const Eigen::VectorXd& q, Eigen::VectorXd* gradient) const { return transform(q, false, gradient); }

std::size_t LogPosterior::likeliest(const Point& at) const {
  if (hypotheses_.size() == 1) return 0;
  const auto weights = density(at).weights;
  return std::size_t(std::max_element(weights.begin(), weights.end()) - weights.begin());
}

Eigen::VectorXd LogPosterior::whitened_residual(const Point& at, std::size_t hypothesis) const {
  const Hypothesis& h = hypotheses_.at(hypothesis);
  const Eigen::VectorXd x = emulator_.features(at.u, at.beyond);
  return (h.data - h.coefficients * x).array() / (1 + emulator_.variance(x) * h.ratio.array()).sqrt();
}

Eigen::MatrixXd LogPosterior::whiten(const Eigen::MatrixXd& directions, const Point& at, std::size_t hypothesis) const {
  const Hypothesis& h = hypotheses_.at(hypothesis);
  const double variance = emulator_.variance(emulator_.features(at.u, at.beyond));
  return (1 + variance * h.ratio.array()).rsqrt().matrix().asDiagonal() * (h.whitener * directions);
}

Eigen::MatrixXd LogPosterior::jacobian(const Point& at) const {
  const Eigen::MatrixXd all = coefficients_ * emulator_.features_slope(at.u, at.beyond);
  Eigen::MatrixXd out(all.rows(), dimension());
  out.leftCols(Eigen::Index(free_.size())) = all(Eigen::all, free_);
  if (has_beyond_) out.col(out.cols() - 1) = all.col(all.cols() - 1);
  return out;
}

}  // namespace calomel
