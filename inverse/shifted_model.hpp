#pragma once
/// Models made of others: with the mesh's error added, and with what was run remembered.
#include <map>
#include <mutex>
#include <vector>

#include "forward/model.hpp"
#include "inverse/likelihood/mesh_error.hpp"

namespace calomel {

/// model + MeshError::shift: what the finer mesh would show, or one beyond it, as far as pairs of runs tell.
class ShiftedModel final : public ForwardModel {
 public:
  /// Both outlive the object; an empty mesh error leaves the model as it is.
  ShiftedModel(const ForwardModel& model, const MeshError& mesh) : model_(model), mesh_(mesh) {}
  [[nodiscard]] const ModelShape& shape() const override { return model_.shape(); }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override;
  [[nodiscard]] Eigen::MatrixXf means(const Eigen::MatrixXd& thetas, int threads) const override;
  [[nodiscard]] HistoryBasis basis() const override;
  [[nodiscard]] Eigen::MatrixXf coefficients(const Eigen::MatrixXd& thetas) const override;
  [[nodiscard]] bool has_gradient() const override { return model_.has_gradient(); }
  /// The slope of the shift included.
  [[nodiscard]] Eigen::VectorXd pull_back(std::span<const double> theta, std::span<const double> weights) const override;

 private:
  const ForwardModel& model_;
  const MeshError& mesh_;
};

/// A model that keeps what it has computed or was told, so that no point is run twice.
class RememberingModel final : public ForwardModel {
 public:
  /// `model` outlives the object.
  explicit RememberingModel(const ForwardModel& model) : model_(model) {}
  [[nodiscard]] const ModelShape& shape() const override { return model_.shape(); }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override;
  /// What the model gives at theta, run elsewhere; the first word stands. `counts`: whether it is one of the runs() of this model.
  void learn(std::span<const double> theta, Prediction prediction, bool counts) const;
  [[nodiscard]] bool knows(std::span<const double> theta) const;
  /// Points that were computed, and those learnt that count.
  [[nodiscard]] std::size_t runs() const { return runs_; }

 private:
  const ForwardModel& model_;
  mutable std::mutex lock_;
  mutable std::map<std::vector<double>, Prediction> known_;
  mutable std::size_t runs_ = 0;
};

}  // namespace calomel
