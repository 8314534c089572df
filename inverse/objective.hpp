#pragma once
/// The formulations of the misfit that are optimised, by name.
#include <Eigen/Core>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/registry.hpp"
#include "inverse/problem.hpp"

namespace calomel {

class Likelihood;

/// What an objective of whole histories says of one.
struct HistoryObjective {
  double value = 0;                            ///< the published number; NaN for a failed run
  std::function<std::vector<double>()> slope;  ///< its gradient by the model's values
};

/// A number made of a Score's averages, or of whole histories, and which way it is better.
struct Objective {
  std::string name;
  bool maximise = false;
  /// accuracy [%], mae, nrmse, delta1, delta2 -> the published number
  std::function<double(double accuracy, double mae, double nrmse, double delta1, double delta2)> formula;
  /// In place of the formula. values: (shape.values()).
  std::function<HistoryObjective(std::span<const double> theta, std::span<const double> values)> of_histories;

  [[nodiscard]] const char* sense() const { return maximise ? "maximise" : "minimise"; }
  /// The published number; NaN for a failed run. Of an objective with a formula.
  [[nodiscard]] double value(const Score& score) const;
  /// The published number -> what an optimiser minimises; a failed run (NaN) is +infinity. Its own inverse on finite numbers.
  [[nodiscard]] double cost(double value) const;
  /// Costs of scores; of an objective with a formula. Result: (n).
  [[nodiscard]] std::vector<double> costs(const BatchScore& scores) const;
  /// Costs of many histories at once. values: (shape.values(), n); thetas: (n_parameters, n), needed only where there is no formula; result: (n).
  [[nodiscard]] std::vector<double> costs(const Problem& problem, const Eigen::MatrixXf& values, const Eigen::MatrixXd& thetas = {}) const;
};

/// paper_enc: ACC[%] - MAE (microstrain for strain), maximised (seed paper, eq. obj); paper_spe: delta1 + 5 delta2, minimised
/// (eq. loss); rrmse: mean relative error over the sensors, minimised.
const Registry<Objective>& objectives();

/// Name of the objective that is not in the catalogue, because it needs a likelihood: the log likelihood of the mean records with errors correlated in
/// time and between gauges, maximised.
inline const std::string correlated_name = "correlated";
/// It. `likelihood` outlives the object.
[[nodiscard]] Objective correlated_objective(const Likelihood& likelihood);

}  // namespace calomel
