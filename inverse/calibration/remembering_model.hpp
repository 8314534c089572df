#pragma once
/// A model that keeps what was run.
#include <map>
#include <mutex>
#include <vector>

#include "forward/model.hpp"

namespace calomel {

/// A model that keeps what it has computed or was given, so that no point is run twice.
class RememberingModel final : public ForwardModel {
 public:
  /// `model` outlives the object.
  explicit RememberingModel(const ForwardModel& model) : model_(model) {}
  [[nodiscard]] const ModelShape& shape() const override { return model_.shape(); }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override;
  [[nodiscard]] std::vector<Prediction> predictions(const Eigen::MatrixXd& thetas, int threads, const Predicted& predicted = {}) const override;
  /// What the model gives at theta, run elsewhere; the first value is kept. `counts`: whether it is one of the runs() of this model.
  void learn(std::span<const double> theta, Prediction prediction, bool counts) const;
  [[nodiscard]] bool knows(std::span<const double> theta) const;
  /// Points that were computed, and the given ones that count.
  [[nodiscard]] std::size_t runs() const { return runs_; }

 private:
  const ForwardModel& model_;
  mutable std::mutex lock_;
  mutable std::map<std::vector<double>, Prediction> known_;
  mutable std::size_t runs_ = 0;
};

}  // namespace calomel
