#pragma once
/// The posterior density of the parameters of a model with cheap runs, by the model itself, without an emulator; or that of a model which is a log density
/// already.
#include <Eigen/Core>
#include <atomic>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/linear_algebra.hpp"
#include "forward/model.hpp"
#include "inverse/posterior/error_model.hpp"
#include "inverse/posterior/prior.hpp"

namespace calomel {

/// log p(theta | records) = log L + log prior on the parameters' bounds, with log L of the records' errors: Gaussian, or Student's t where their scale was
/// estimated from few squares. Without errors the model's one value is log L.
///
/// Coordinates q are unconstrained: the logit of a parameter's place between its bounds, those of its prior's support where these are narrower.
class ModelPosterior {
 public:
  /// The model outlives the object. Errors: NumericsError where the errors' covariance is not positive definite.
  ModelPosterior(const ForwardModel& model, std::optional<ErrorModel> errors);

  [[nodiscard]] Eigen::Index dimension() const { return Eigen::Index(priors_.size()); }
  [[nodiscard]] const std::vector<Parameter>& parameters() const { return model_.shape().parameters; }
  [[nodiscard]] const std::vector<Prior>& priors() const { return priors_; }
  [[nodiscard]] std::vector<double> theta(const Eigen::VectorXd& q) const;
  /// What lies on an edge is moved a part in 10^6 inwards.
  [[nodiscard]] Eigen::VectorXd q(std::span<const double> theta) const;
  /// dtheta/dq, (dimension).
  [[nodiscard]] Eigen::VectorXd scale(const Eigen::VectorXd& q) const;

  /// Values of the model at q, (values); NaN where it has no answer.
  [[nodiscard]] Eigen::VectorXd prediction(const Eigen::VectorXd& q) const;
  /// log L; minus infinity where the model has no answer.
  [[nodiscard]] double log_likelihood(std::span<const double> theta) const;
  /// log prior + log |dtheta/dq|; minus infinity beyond the prior's support.
  [[nodiscard]] double log_prior(const Eigen::VectorXd& q) const;
  /// log L + log_prior.
  [[nodiscard]] double log_density(const Eigen::VectorXd& q) const;
  /// Whether there is a gradient: of a log density whose model has one.
  [[nodiscard]] bool has_gradient() const { return !errors_ && model_.has_gradient(); }
  double log_density(const Eigen::VectorXd& q, Eigen::VectorXd& gradient) const;

  [[nodiscard]] bool is_log_density() const { return !errors_.has_value(); }
  /// None of a log density.
  [[nodiscard]] const std::optional<ErrorModel>& errors() const { return errors_; }
  /// Calls of the model that had no answer so far, and the first reason.
  [[nodiscard]] std::size_t failed() const { return failed_; }

 private:
  /// Values of the model at theta; empty where it has none.
  [[nodiscard]] std::vector<double> history(std::span<const double> theta) const;
  const ForwardModel& model_;
  std::optional<ErrorModel> errors_;
  std::vector<Prior> priors_;
  std::vector<double> low_, high_;
  Cholesky factor_;
  double freedom_ = 0, log_norm_ = 0;
  mutable std::atomic<std::size_t> failed_ = 0;
};

}  // namespace calomel
