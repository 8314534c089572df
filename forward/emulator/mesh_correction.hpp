#pragma once
/// What the finest mesh of the emulator shows beyond the case's own: searches and decisions on the case's mesh take it off with this.
#include <span>
#include <string>
#include <vector>

#include "forward/emulator/multilevel.hpp"
#include "forward/model.hpp"

namespace calomel {

/// The emulator's history on the finest mesh less that on the working mesh, over the parameters of a case:
///
///     shift(theta) = H G' (features(u_fine, 0) - level_features(u_working, level)),
///
/// H the histories of the runs, G their gain. u_fine and u_working hold theta and the numbers that the emulator has beside it, such as the regularising
/// viscosity, as they are on either mesh. Outside the emulator's box the shift is that of the box's nearest point.
class MeshCorrection {
 public:
  MeshCorrection() = default;  ///< none
  /// histories: (values, runs) of the regression's runs. working_level: that of the working mesh, 0 where only what follows differs. fixed_fine, fixed_working:
  /// values of those parameters of the box that follow the case's own. Errors: contract failure for shapes that do not fit together.
  MeshCorrection(EmulatorBox box, const MultilevelRegression& regression, const Eigen::MatrixXd& histories, int working_level, std::vector<double> fixed_fine,
                 std::vector<double> fixed_working);

  [[nodiscard]] bool empty() const { return directions_.size() == 0; }
  /// Reservations about it, by its maker.
  std::vector<std::string> reservations;
  /// Runs that it was trained on.
  [[nodiscard]] Eigen::Index runs() const { return regression_.size(); }
  /// Whether theta, with the fixed numbers of either mesh, lies in the emulator's box.
  [[nodiscard]] bool inside(std::span<const double> theta) const;
  /// (values); of one that is not empty, as all that follows.
  [[nodiscard]] Eigen::VectorXd shift(std::span<const double> theta) const { return directions_ * weights(theta); }
  /// (values, n_directions): shift = directions * weights(theta). One for each coefficient of the regression, of which there are fewer than runs.
  [[nodiscard]] const Eigen::MatrixXd& directions() const { return directions_; }
  [[nodiscard]] Eigen::VectorXd weights(std::span<const double> theta) const;
  /// Gradient of sum_i weights_i shift_i(theta) by theta, (n_parameters); 0 in a coordinate outside the box.
  [[nodiscard]] Eigen::VectorXd vector_jacobian_product(std::span<const double> theta, std::span<const double> weights) const;

 private:
  [[nodiscard]] std::vector<double> with(std::span<const double> theta, const std::vector<double>& fixed) const;
  [[nodiscard]] Eigen::VectorXd features(const Eigen::VectorXd& u_fine, const Eigen::VectorXd& u_working) const;
  EmulatorBox box_;
  MultilevelRegression regression_;
  Eigen::MatrixXd directions_;
  int level_ = 0;
  std::vector<double> fine_, working_;
};

/// model + MeshCorrection::shift, for every function of a model.
class CorrectedModel final : public ForwardModel {
 public:
  /// Both outlive the object; an empty correction leaves the model as it is.
  CorrectedModel(const ForwardModel& model, const MeshCorrection& correction) : model_(model), correction_(correction) {}
  [[nodiscard]] const ModelShape& shape() const override { return model_.shape(); }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override;
  [[nodiscard]] std::vector<Prediction> predictions(const Eigen::MatrixXd& thetas, int threads, const Predicted& predicted = {}) const override;
  [[nodiscard]] Eigen::MatrixXf means(const Eigen::MatrixXd& thetas, int threads) const override;
  [[nodiscard]] HistoryBasis basis() const override;
  [[nodiscard]] Eigen::MatrixXf coefficients(const Eigen::MatrixXd& thetas) const override;
  [[nodiscard]] bool has_gradient() const override { return model_.has_gradient(); }
  [[nodiscard]] Eigen::VectorXd vector_jacobian_product(std::span<const double> theta, std::span<const double> weights) const override;

 private:
  [[nodiscard]] Prediction corrected(Prediction prediction, std::span<const double> theta) const;
  const ForwardModel& model_;
  const MeshCorrection& correction_;
};

}  // namespace calomel
