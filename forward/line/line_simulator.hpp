#pragma once
/// Waves along a bar or a pipe as a Simulator.
#include "forward/line/line_model.hpp"
#include "forward/simulation/simulator.hpp"
#include "forward/simulation/simulator_kinds.hpp"

namespace calomel {

class LineSimulator final : public Simulator {
 public:
  /// files: those that the model reads, by the case's key.
  explicit LineSimulator(LineCase line_case, std::map<std::string, std::filesystem::path> files = {});

  [[nodiscard]] const std::string& name() const override { return model_.line_case().name; }
  [[nodiscard]] const ModelShape& shape() const override { return model_.shape(); }
  [[nodiscard]] const Capabilities& capabilities() const override { return capabilities_; }
  [[nodiscard]] Prediction evaluate(const RunRequest& request) const override;
  /// The mechanisms that the line offers (LineModel::offered). The response of a single station is a group like any other; with several stations it acts on
  /// each of them alone.
  [[nodiscard]] std::vector<ParameterGroup> offered() const override;
  [[nodiscard]] Description describe(int threads = 1) const override;
  [[nodiscard]] SimulatorIdentity identity() const override;
  [[nodiscard]] Json echo() const override { return model_.line_case().echo(); }
  [[nodiscard]] InferenceHints hints() const override;
  [[nodiscard]] Simulated simulate(const SimulateCall& call) const override;

  [[nodiscard]] const LineModel& model() const { return model_; }

 private:
  LineModel model_;
  std::map<std::string, std::filesystem::path> files_;
  Capabilities capabilities_;
};

/// The tables of a line for the reference of the case file, in Markdown; and its mechanisms.
std::string line_reference();
std::vector<Catalogue> line_catalogues();

SimulatorKind line_kind();

}  // namespace calomel
