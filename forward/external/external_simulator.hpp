#pragma once
/// An external model behind UM-Bridge as a Simulator.
#include <mutex>

#include "forward/external/external_model.hpp"
#include "forward/simulation/simulator.hpp"
#include "forward/simulation/simulator_kinds.hpp"

namespace calomel {

class ExternalSimulator final : public Simulator {
 public:
  explicit ExternalSimulator(ExternalCase external);

  [[nodiscard]] const std::string& name() const override { return case_.name; }
  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] const Capabilities& capabilities() const override { return capabilities_; }
  /// Errors: those of ExternalModel at the first call, when the server is contacted.
  [[nodiscard]] Prediction evaluate(const RunRequest& request) const override;
  [[nodiscard]] std::vector<ParameterGroup> offered() const override { return offered_groups(case_); }
  [[nodiscard]] Description describe(int threads = 1) const override;
  [[nodiscard]] SimulatorIdentity identity() const override;
  [[nodiscard]] Json echo() const override { return case_.echo(); }
  [[nodiscard]] InferenceHints hints() const override;
  [[nodiscard]] Simulated simulate(const SimulateCall& call) const override;
  [[nodiscard]] bool has_gradient() const override { return model().has_gradient(); }
  [[nodiscard]] Eigen::VectorXd gradient(std::span<const double> theta, std::span<const double> weights) const override {
    return model().vector_jacobian_product(theta, weights);
  }

 private:
  /// The connection, made when it is first needed.
  [[nodiscard]] const ExternalModel& model() const;
  ExternalCase case_;
  ModelShape shape_;
  Capabilities capabilities_;
  mutable std::mutex lock_;
  mutable std::unique_ptr<ExternalModel> model_;
};

/// The tables of an external model for the reference of the case file, in Markdown.
std::string external_reference();

SimulatorKind external_kind();

}  // namespace calomel
