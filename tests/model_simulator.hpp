#pragma once
// A ForwardModel as a Simulator, for tests of what runs the true model.
#include <memory>

#include "forward/simulation/runs.hpp"

namespace calomel {

class ModelSimulator final : public Simulator {
 public:
  /// The model outlives the object.
  explicit ModelSimulator(const ForwardModel& model) : model_(model) {}
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] const ModelShape& shape() const override { return model_.shape(); }
  [[nodiscard]] const Capabilities& capabilities() const override { return capabilities_; }
  [[nodiscard]] Prediction evaluate(const RunRequest& request) const override { return model_.evaluate(theta_at(model_.shape().parameters, request)); }
  [[nodiscard]] std::vector<ParameterGroup> offered() const override { return {}; }
  [[nodiscard]] Description describe(int) const override { return {}; }
  [[nodiscard]] SimulatorIdentity identity() const override { return {}; }
  [[nodiscard]] Json echo() const override { return Json::object(); }
  [[nodiscard]] Simulated simulate(const SimulateCall&) const override { return {}; }
  [[nodiscard]] bool has_gradient() const override { return model_.has_gradient(); }
  [[nodiscard]] Eigen::VectorXd gradient(std::span<const double> theta, std::span<const double> weights) const override {
    return model_.vector_jacobian_product(theta, weights);
  }

 private:
  const ForwardModel& model_;
  std::string name_ = "a model of a test";
  Capabilities capabilities_{.cheap_runs = true};
};

/// Runs of a simulator on threads, kept in memory.
class RunsInMemory {
 public:
  explicit RunsInMemory(const Simulator& simulator, int threads = 1, const std::atomic<bool>* stop = nullptr)
      : executor_(threads), runs_(simulator, store_, executor_, stop) {}
  operator Runs&() { return runs_; }
  Runs& operator*() { return runs_; }
  Runs* operator->() { return &runs_; }

 private:
  RunStore store_;
  ThreadExecutor executor_;
  Runs runs_;
};

/// The same of a ForwardModel.
class RunsOfModel {
 public:
  explicit RunsOfModel(const ForwardModel& model, int threads = 1, const std::atomic<bool>* stop = nullptr)
      : simulator_(model), runs_(simulator_, threads, stop) {}
  operator Runs&() { return runs_; }
  Runs& operator*() { return runs_; }

 private:
  ModelSimulator simulator_;
  RunsInMemory runs_;
};

}  // namespace calomel
