#pragma once
/// Many small numbers whose effect is taken for linear about where they come out.
#include <Eigen/Core>
#include <vector>

#include "uq/diagnosis/question.hpp"

namespace calomel {

/// What a group of such numbers does about some values of them: rest + effects . values, the effects being the question's.
struct Linearised {
  Question q;
  Eigen::VectorXd rest = {};                            ///< (values of the model)
  Eigen::VectorXd values = {}, sd = {};                 ///< that came out, from off; empty: not asked yet
  std::vector<double> theta = {};                       ///< of the rest of the model, beside them
  bool stays = false;                                   ///< they came out where they were linearised
  std::vector<WeightedErrors> without = {}, with = {};  ///< of that fit: hypotheses about the records less `rest`, and those with the numbers as one more term

  /// They have come out there; theta: of the rest of the model.
  void came_out(const FirstOrder& worth, const std::vector<double>& at);
  /// Points that tell their effect about these values, or as near as their ranges let them be, (theta and the group's numbers, n + 2): all of them off, there,
  /// and one further along each.
  [[nodiscard]] Eigen::MatrixXd points(const ParameterGroup& group) const;
  /// Takes rest and effects from the runs of points(), by least squares over these and those of all times before: a single difference of two runs has the noise
  /// of both.
  void learn(const Eigen::MatrixXd& thetas, const std::vector<RunRecord>& records, const Decimation& grid);

 private:
  std::vector<Eigen::VectorXd> run_ = {}, changes_ = {};  ///< values that were run, and what they changed
};

}  // namespace calomel
