#pragma once
/// The built-in model of a target as a Simulator: the explicit solver on the case's own mesh and on others.
#include <deque>
#include <future>
#include <map>
#include <mutex>
#include <utility>

#include "forward/simulation/simulator.hpp"
#include "forward/simulation/simulator_kinds.hpp"
#include "forward/target/built_in_model.hpp"

namespace calomel {

/// Dotted keys of the regularising viscosity, of the steel's Young modulus and of the mercury that remains on walls.
inline constexpr const char* viscosity_key = "material.mercury.regularising_viscosity";
inline constexpr const char* young_key = "material.steel.young";
inline constexpr const char* film_key = "material.mercury.wall_film";

class TargetSimulator final : public Simulator {
 public:
  /// files: those that the model reads, by the case's key.
  TargetSimulator(ForwardCase forward_case, const SimulatorSettings& settings, std::map<std::string, std::filesystem::path> files = {});
  ~TargetSimulator() override;

  [[nodiscard]] const std::string& name() const override { return case_.name; }
  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] const Capabilities& capabilities() const override { return capabilities_; }
  [[nodiscard]] Prediction evaluate(const RunRequest& request) const override;
  [[nodiscard]] double cost(const RunRequest& request) const override;
  [[nodiscard]] std::vector<ParameterGroup> offered() const override;
  [[nodiscard]] std::vector<ParameterGroup> terms() const override;
  [[nodiscard]] Description describe(int threads = 1) const override;
  [[nodiscard]] SimulatorIdentity identity() const override;
  [[nodiscard]] Json echo() const override { return case_.echo(); }
  [[nodiscard]] InferenceHints hints() const override;
  [[nodiscard]] Simulated simulate(const SimulateCall& call) const override;
  [[nodiscard]] Range range(const Parameter& parameter) const override { return case_.about(parameter.key).range; }
  [[nodiscard]] std::optional<double> table_value(const Parameter& parameter) const override { return case_.number(parameter.key); }
  [[nodiscard]] MeshScale mesh_scale(const RunRequest& request) const override;
  [[nodiscard]] bool move_gauge(RunRequest& request, std::size_t sensor, double by) const override;
  [[nodiscard]] std::vector<KeyDifference> score_test_keys(const RunRequest& request) const override;
  [[nodiscard]] std::optional<TargetView> target() const override;
  void write_mesh(const std::filesystem::path& path) const override;
  [[nodiscard]] std::optional<PlannedCase> planned(int gauges, const std::vector<double>& energies) const override;

  [[nodiscard]] const ForwardCase& forward_case() const { return case_; }
  /// The model of the case itself, for runs on `threads` threads each.
  [[nodiscard]] std::shared_ptr<const BuiltInModel> model(int threads = 1) const;

 protected:
  void add_energies(const RunRequest& request, RunRecord& record) const override;

 private:
  /// A request taken apart: numbers that one mesh serves, and those for which a model of its own is made.
  struct Numbers {
    std::vector<std::string> keys;          ///< of the former
    std::vector<double> theta;              ///< their values
    std::map<std::string, double> changed;  ///< the latter
  };
  [[nodiscard]] Numbers numbers_of(const RunRequest& request) const;
  [[nodiscard]] ForwardCase case_of(const RunRequest& request, const std::vector<std::string>& keys) const;
  [[nodiscard]] EnsembleOptions ensemble_of(const RunRequest& request) const;
  /// The model of a request's mesh with these numbers as parameters; and the same as it is kept, or made now.
  [[nodiscard]] std::shared_ptr<const BuiltInModel> made_model(const RunRequest& request, const std::vector<std::string>& keys, int threads) const;
  [[nodiscard]] std::shared_ptr<const BuiltInModel> kept_model(const RunRequest& request, const std::vector<std::string>& keys, int threads) const;
  /// f(model, theta) with the model of a request. Errors: InputError where a changed number leads outside what the target allows.
  template <class F>
  auto with_model(const RunRequest& request, F&& f) const;

  ForwardCase case_;
  EnsembleOptions ensemble_;
  std::map<std::string, std::filesystem::path> files_;
  ModelShape shape_;
  Capabilities capabilities_;
  /// Models that were made last, each by what decides it; one that is being made is waited for.
  using Model = std::shared_ptr<const BuiltInModel>;
  mutable std::mutex lock_;
  mutable std::deque<std::pair<std::string, std::shared_future<Model>>> models_;
};

/// The shape of a case's records; it needs no mesh.
ModelShape shape_of(const ForwardCase& forward_case);

/// The tables of a target for the reference of the case file, in Markdown; and its laws, loads and mechanisms.
std::string target_reference();
std::vector<Catalogue> target_catalogues();

SimulatorKind target_kind();

}  // namespace calomel
