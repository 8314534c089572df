#pragma once
/// A surrogate set right where runs of the true model were added: what it missed there is kriged over the parameters.
#include <functional>

#include "forward/model.hpp"
#include "inverse/likelihood/kriging.hpp"

namespace calomel {

class RefinedModel final : public ForwardModel {
 public:
  using Variance = std::function<Eigen::VectorXd(std::span<const double>)>;
  /// theta: (n_parameters, runs), two or more; truth: (values, runs), the true model there; `variance`: of (model - base), (values). Both outlive the object.
  RefinedModel(const ForwardModel& base, const Variance& variance, const Eigen::MatrixXd& theta, const Eigen::MatrixXd& truth);

  [[nodiscard]] const ModelShape& shape() const override { return base_.shape(); }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override;
  [[nodiscard]] Eigen::MatrixXf means(const Eigen::MatrixXd& thetas, int threads) const override;
  [[nodiscard]] HistoryBasis basis() const override;
  [[nodiscard]] Eigen::MatrixXf coefficients(const Eigen::MatrixXd& thetas) const override;
  [[nodiscard]] bool has_gradient() const override { return base_.has_gradient(); }
  [[nodiscard]] Eigen::VectorXd pull_back(std::span<const double> theta, std::span<const double> weights) const override;

  /// Variance of (model - this) at theta, (values): the base's, falling towards the added runs as kriging says, and raised everywhere by what the errors
  /// at the added runs were over what the base had promised there.
  [[nodiscard]] Eigen::VectorXd error_variance(std::span<const double> theta) const;
  /// Mean square of the base's errors at the added runs over its variance there.
  [[nodiscard]] double base_ratio() const { return ratio_; }
  [[nodiscard]] const Kriging& kriging() const { return kriging_; }

 private:
  const ForwardModel& base_;
  const Variance& variance_;
  Eigen::MatrixXd errors_;  ///< (values, runs), true - base
  Kriging kriging_;
  double ratio_ = 1;
};

}  // namespace calomel
