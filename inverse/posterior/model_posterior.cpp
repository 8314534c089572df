#include "inverse/posterior/model_posterior.hpp"

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/not_finite.hpp"
#include "inverse/posterior/error_density.hpp"

namespace calomel {

namespace {

constexpr double edge = 1e-6;  ///< of the bounds' distance

/// 1 / (1 + exp(-q)) without loss at either end.
double logistic(double q) { return q >= 0 ? 1 / (1 + std::exp(-q)) : std::exp(q) / (1 + std::exp(q)); }

}  // namespace

ModelPosterior::ModelPosterior(const ForwardModel& model, std::optional<ErrorModel> errors)
    : model_(model), errors_(std::move(errors)), priors_(priors_of(model.shape().parameters)) {
  for (std::size_t k = 0; k < priors_.size(); ++k) {
    low_.push_back(std::max(parameters()[k].min, priors_[k].low()));
    high_.push_back(std::min(parameters()[k].max, priors_[k].high()));
    if (!(low_[k] < high_[k])) throw InputError({.problem = "the prior has no probability between the bounds", .key = "parameter." + parameters()[k].name});
  }
  if (!errors_) return;
  factor_ = Cholesky(errors_->covariance());
  if (!factor_.positive_definite()) throw NumericsError("the covariance of the records' errors is not positive definite");
  freedom_ = errors_->freedom();
  log_norm_ = log_norm_of_errors(freedom_, double(errors_->data().size())) - factor_.half_log_determinant();
}

std::vector<double> ModelPosterior::theta(const Eigen::VectorXd& q) const {
  std::vector<double> out;
  for (std::size_t k = 0; k < priors_.size(); ++k) out.push_back(std::clamp(low_[k] + (high_[k] - low_[k]) * logistic(q[Eigen::Index(k)]), low_[k], high_[k]));
  return out;
}

Eigen::VectorXd ModelPosterior::q(std::span<const double> theta) const {
  Eigen::VectorXd out(dimension());
  for (std::size_t k = 0; k < priors_.size(); ++k) {
    const double place = std::clamp((theta[k] - low_[k]) / (high_[k] - low_[k]), edge, 1 - edge);
    out[Eigen::Index(k)] = std::log(place / (1 - place));
  }
  return out;
}

Eigen::VectorXd ModelPosterior::scale(const Eigen::VectorXd& q) const {
  Eigen::VectorXd out(dimension());
  for (std::size_t k = 0; k < priors_.size(); ++k) {
    const double place = logistic(q[Eigen::Index(k)]);
    out[Eigen::Index(k)] = (high_[k] - low_[k]) * place * (1 - place);
  }
  return out;
}

std::vector<double> ModelPosterior::history(std::span<const double> theta) const {
  const auto p = model_.evaluate(theta);
  if (p.ok && std::all_of(p.mean.begin(), p.mean.end(), [](double x) { return std::isfinite(x); })) return p.mean;
  ++failed_;
  return {};
}

Eigen::VectorXd ModelPosterior::prediction(const Eigen::VectorXd& q) const {
  auto y = history(theta(q));
  y.resize(model_.shape().values(), nan);
  return Eigen::Map<const Eigen::VectorXd>(y.data(), Eigen::Index(y.size()));
}

double ModelPosterior::log_likelihood(std::span<const double> theta) const {
  const auto y = history(theta);
  if (y.empty()) return -infinity;
  if (!errors_) return y[0];
  const Eigen::VectorXd r =
      factor_.solve_lower(Eigen::VectorXd(errors_->data() - errors_->grid().apply(Eigen::Map<const Eigen::VectorXd>(y.data(), Eigen::Index(y.size())))));
  return log_norm_ - penalty_of_errors(r.squaredNorm(), freedom_, double(r.size()));
}

double ModelPosterior::log_prior(const Eigen::VectorXd& q) const {
  const Eigen::VectorXd jacobian = scale(q);
  if (!((jacobian.array() > 0).all())) return -infinity;  // so far out that the bounds are met to the last digit
  const double prior = calomel::log_prior(priors_, theta(q));
  return std::isfinite(prior) ? prior + jacobian.array().log().sum() : -infinity;
}

double ModelPosterior::log_density(const Eigen::VectorXd& q) const {
  const double prior = log_prior(q);
  return std::isfinite(prior) ? log_likelihood(theta(q)) + prior : -infinity;
}

double ModelPosterior::log_density(const Eigen::VectorXd& q, Eigen::VectorXd& gradient) const {
  const double value = log_density(q);
  gradient = Eigen::VectorXd::Zero(dimension());
  if (!std::isfinite(value)) return value;
  const Eigen::VectorXd jacobian = scale(q);
  const auto at = theta(q);
  const double one = 1;
  gradient = model_.vector_jacobian_product(at, {&one, 1});
  for (std::size_t k = 0; k < priors_.size(); ++k) {
    const auto i = Eigen::Index(k);
    gradient[i] = (gradient[i] + priors_[k].log_density_slope(at[k])) * jacobian[i] + 1 - 2 * logistic(q[i]);
  }
  return value;
}

}  // namespace calomel
