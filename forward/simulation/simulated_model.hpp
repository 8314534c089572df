#pragma once
/// The true model as a ForwardModel, for what works on any model: the candidates of a calibration, a sensitivity analysis, a chain.
#include "forward/simulation/runs.hpp"

namespace calomel {

class SimulatedModel final : public ForwardModel {
 public:
  /// `kept`: whether runs go through the store; else each is made again in double precision, as a chain needs them. `runs` outlives the object.
  explicit SimulatedModel(Runs& runs, bool kept = true, Runs::Progress progress = {}) : runs_(runs), kept_(kept), progress_(std::move(progress)) {}

  [[nodiscard]] const ModelShape& shape() const override { return runs_.simulator().shape(); }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override;
  [[nodiscard]] std::vector<Prediction> predictions(const Eigen::MatrixXd& thetas, int threads, const Predicted& predicted = {}) const override;
  [[nodiscard]] Eigen::MatrixXf means(const Eigen::MatrixXd& thetas, int threads) const override;
  [[nodiscard]] bool has_gradient() const override { return runs_.simulator().has_gradient(); }
  [[nodiscard]] Eigen::VectorXd vector_jacobian_product(std::span<const double> theta, std::span<const double> weights) const override {
    return runs_.simulator().gradient(theta, weights);
  }

 private:
  [[nodiscard]] std::vector<RunRecord> records(const Eigen::MatrixXd& thetas, const Runs::Progress& progress) const;
  Runs& runs_;
  bool kept_;
  Runs::Progress progress_;
};

}  // namespace calomel
