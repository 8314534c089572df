#pragma once
/// The formulations of the misfit that are optimised, by name.
#include <Eigen/Core>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/registry.hpp"
#include "inverse/data/problem.hpp"

namespace calomel {

/// Averages and sums of Score for many columns at once, in single precision. values: (shape.values(), n).
/// A column with a NaN gives NaN. Results: (n) each.
struct BatchScore {
  std::vector<double> accuracy, mae, nrmse, delta1, delta2;
};
BatchScore score_batch(const Problem& problem, const Eigen::MatrixXf& values);

/// A number made of a Score's averages, and which way it is better.
struct Objective {
  std::string name;
  bool maximise = false;
  /// accuracy [%], mae, nrmse, delta1, delta2 -> the published number
  std::function<double(double accuracy, double mae, double nrmse, double delta1, double delta2)> formula;

  [[nodiscard]] const char* sense() const { return maximise ? "maximise" : "minimise"; }
  /// The published number; NaN for a failed run.
  [[nodiscard]] double value(const Score& score) const;
  /// The published number -> what an optimiser minimises; a failed run (NaN) is +infinity. Its own inverse on finite numbers.
  [[nodiscard]] double cost(double value) const;
  /// Costs of scores. Result: (n).
  [[nodiscard]] std::vector<double> costs(const BatchScore& scores) const;
  /// Costs of many histories at once. values: (shape.values(), n); result: (n).
  [[nodiscard]] std::vector<double> costs(const Problem& problem, const Eigen::MatrixXf& values) const;
};

/// paper_enc: ACC[%] - MAE (microstrain for strain), maximised (seed paper, eq. obj); paper_spe: delta1 + 5 delta2, minimised
/// (eq. loss); rrmse: mean relative error over the sensors, minimised.
const Registry<Objective>& objectives();

}  // namespace calomel
