#pragma once
/// Where the model runs: estimated from the failed runs of a campaign, so that searches avoid the rest.
#include <Eigen/Core>
#include <functional>
#include <map>
#include <span>
#include <string>

#include "forward/campaign/archive.hpp"

namespace calomel {

/// Share of failures among the neighbours of a point: p = (sum_i w_i f_i + m b) / (sum_i w_i + m), w_i = exp(-(d_i / h)^2 / 2), d_i the distance to run i in
/// parameters scaled to their bounds, h a multiple of the distance to the fifth neighbour, f_i 1 where the run failed, b the campaign's own share and m a
/// twentieth of a run (Nadaraya 1964 and Watson 1964, drawn to the base rate where nothing is near). The multiple is the one whose leave-one-out
/// probabilities have the greatest likelihood.
class Feasibility {
 public:
  /// theta: (n_parameters, runs); failed: (runs). No failures: everything is feasible.
  Feasibility(const std::vector<Parameter>& parameters, const Eigen::MatrixXd& theta, const std::vector<bool>& failed);
  explicit Feasibility(const Archive& archive);

  [[nodiscard]] bool any_failed() const { return failures_ > 0; }
  [[nodiscard]] double failure_probability(std::span<const double> theta) const;
  /// Whether a search may go there: a run fails with a probability below a quarter. At one half every other candidate on the boundary would fail.
  [[nodiscard]] bool feasible(std::span<const double> theta) const { return !any_failed() || failure_probability(theta) < 0.25; }
  /// Share of the runs that the others classify rightly.
  [[nodiscard]] double leave_one_out_accuracy() const { return accuracy_; }
  [[nodiscard]] std::size_t failures() const { return failures_; }

 private:
  [[nodiscard]] Eigen::VectorXd scaled(std::span<const double> theta) const;
  /// At a scaled point; run `without` is left out (-1: none).
  [[nodiscard]] double probability(const Eigen::VectorXd& u, double multiple, Eigen::Index without) const;
  std::vector<Parameter> parameters_;
  Eigen::MatrixXd points_;  ///< scaled, (n_parameters, runs)
  Eigen::VectorXd failed_;  ///< 1 or 0
  std::size_t failures_ = 0;
  double multiple_ = 1, accuracy_ = 1;
};

/// The reasons of failed runs, numbers taken out, and how often each was given.
std::map<std::string, std::size_t> failure_reasons(const Archive& archive);

/// A surrogate that fails at points where the true model is likely to fail.
class GuardedModel final : public ForwardModel {
 public:
  /// Both outlive the object.
  GuardedModel(const ForwardModel& model, const Feasibility& feasibility) : model_(model), feasibility_(feasibility) {}
  [[nodiscard]] const ModelShape& shape() const override { return model_.shape(); }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override;
  [[nodiscard]] Eigen::MatrixXf means(const Eigen::MatrixXd& thetas, int threads) const override;
  [[nodiscard]] HistoryBasis basis() const override { return model_.basis(); }
  [[nodiscard]] Eigen::MatrixXf coefficients(const Eigen::MatrixXd& thetas) const override;
  [[nodiscard]] bool has_gradient() const override { return model_.has_gradient(); }
  [[nodiscard]] Eigen::VectorXd vector_jacobian_product(std::span<const double> theta, std::span<const double> weights) const override {
    return model_.vector_jacobian_product(theta, weights);
  }

 private:
  /// Columns of `y` at points where the true model is likely to fail become NaN.
  [[nodiscard]] Eigen::MatrixXf guarded(const Eigen::MatrixXd& thetas, Eigen::MatrixXf y) const;
  const ForwardModel& model_;
  const Feasibility& feasibility_;
};

}  // namespace calomel
