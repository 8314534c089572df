#pragma once
/// The effect of many small numbers, taken for linear about their estimate.
#include <Eigen/Core>
#include <vector>

#include "uq/diagnosis/screening.hpp"

namespace calomel {

/// The effect of a group of such numbers about some values of them: rest + effects . values, with the effects of the candidate.
struct LinearisedEffect {
  ScreenedCandidate candidate;
  Eigen::VectorXd rest = {};             ///< (values of the model)
  Eigen::VectorXd values = {}, sd = {};  ///< estimate of the numbers, from off; empty: not estimated yet
  std::vector<double> theta = {};        ///< the rest of the model's parameters, beside them
  bool converged = false;                ///< the estimate is where the effect was linearised
  std::vector<WeightedErrors> without = {},
                              with = {};  ///< hypotheses of that fit about the records less `rest`, and the same with the numbers as one more term

  /// Takes a new estimate. at: the rest of the model's parameters.
  void set_estimate(const FirstOrderEstimate& estimate, const std::vector<double>& at);
  /// Points that show the effect about the estimate, or as near as the ranges of the numbers let them be, (theta and the group's numbers, n + 2): all numbers
  /// off, all at the estimate, and one further along each.
  [[nodiscard]] Eigen::MatrixXd points(const ParameterGroup& group) const;
  /// Takes rest and effects from the runs of points(), by least squares over these and those of all times before: a single difference of two runs has the noise
  /// of both.
  void update(const Eigen::MatrixXd& thetas, const std::vector<RunRecord>& records, const Decimation& grid);

 private:
  std::vector<Eigen::VectorXd> run_ = {}, changes_ = {};  ///< values that were run, and their effects
};

}  // namespace calomel
