#pragma once
/// The true model of a case, whatever its kind: the built-in solver, waves along a line, a model behind a server.
#include <Eigen/Core>
#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "forward/model.hpp"
#include "forward/parameter_group.hpp"
#include "forward/simulation/inference_hints.hpp"
#include "forward/simulation/mechanism_directions.hpp"
#include "forward/simulation/run_record.hpp"
#include "forward/simulation/run_request.hpp"

namespace calomel {

struct LocatedGauge;
struct Mesh;

/// What a model can do beside runs for the mean. No other code queries the kind of a model.
struct Capabilities {
  enum class Meshes {
    none,   ///< the model has no mesh
    fixed,  ///< the mesh comes from a file and has one element size
    sizes   ///< the mesh can be made with elements of another size
  };
  Meshes meshes = Meshes::none;
  bool cheap_runs = false;      ///< a run costs so little that fits and chains may use the model itself
  bool pulses = false;          ///< a mean over pulse energies, with the single pulses
  bool energy_balance = false;  ///< Outputs::energy_balance and Outputs::totals
  bool numerics = false;        ///< jitter, energy_shift, refine, precision and viscosity_factor of a request: the repeatability floor can be measured
  bool strain_gauges = false;   ///< the records are strains of gauges on a vessel
  bool planning = false;        ///< planned() adds gauges and beam energies to the case
  bool log_density = false;     ///< the model's one value is a log density, for samplers only
};

/// A line of a description: "mesh", "scaled Jacobian at least 0.8, ...".
struct Fact {
  std::string label, text;
};

/// What a run costs.
struct RunCost {
  double run_s = 0;             ///< one pulse of every condition, on one thread [s]
  double mean_s = 0;            ///< one mean over the pulse energies of every condition, on one thread [s]
  int run_threads = 1;          ///< threads that a single run gains by
  double run_gain = 1;          ///< speed of a single run on these threads, over one thread
  std::size_t elements = 0;     ///< of the case's own mesh
  int refinement_exponent = 4;  ///< work grows as (1 / element size) to this power: 3 in plane strain, 4 in three dimensions
  std::string precision;        ///< "single" or "double"
};

/// A model as `check` shows it and `simulate` records it.
struct Description {
  std::vector<Fact> facts;            ///< all lines, in order
  std::vector<Fact> physics;          ///< those that `simulate` shows again
  std::vector<std::string> warnings;  ///< what may be wrong with the case
  std::vector<std::string> notes;     ///< what is good to know
  std::optional<RunCost> cost;        ///< of a model whose runs are long enough to count
  Json summary = Json::object();      ///< for simulate.json: elements, nodes, ..., null where the model has none
};

/// What decides the values of a model's runs, for provenance.
struct SimulatorIdentity {
  Json options = Json::object();              ///< by table, parameters with their bounds
  std::map<std::string, std::string> inputs;  ///< hashes of the files that the model reads, by the case's key
  Json simulate = Json::object();             ///< further options that decide the artefacts of `simulate` alone
  Json offered = Json::object();              ///< further options that decide which mechanisms a diagnosis is offered
};

/// A call of `simulate`: one run at energy 1 of the case, or the mean.
struct SimulateCall {
  bool mean = false;
  int threads = 1;
  const std::atomic<bool>* stop = nullptr;
  std::filesystem::path checkpoint;      ///< of a run that may be interrupted; empty: the default place is not used
  std::string identity;                  ///< of the call, for the checkpoint
  bool fresh = false;                    ///< checkpoints that exist are set aside
  std::filesystem::path fields;          ///< fields over time are written there; empty: no fields
  std::optional<double> field_interval;  ///< [s]
  std::function<void(double share)> progress;
  std::function<void(const std::string& condition, std::int64_t step, bool finished)> resumed;  ///< the run of this condition went on from this step
};

struct Simulated {
  std::vector<double> values;     ///< (condition, sensor, time)
  Json summary = Json::object();  ///< for simulate.json: steps, time_step_s, wall_s, ...
  std::int64_t steps = 0;         ///< 0: the model has no steps
  std::size_t elements = 0;       ///< 0: the model has no elements
  double wall_s = 0, element_steps_per_s = 0;
};

/// The target for pictures.
struct TargetView {
  std::shared_ptr<const void> owner;  ///< of the mesh and the gauges
  const Mesh* mesh = nullptr;
  std::span<const LocatedGauge> gauges;
  std::vector<std::array<double, 3>> declared;  ///< places of the gauges in the case [m]
  std::vector<double> gauge_lengths;            ///< [m]
  std::string load_policy;                      ///< how the load follows the parameters, in words
  double deposited_energy = 0;                  ///< [J]; 0: unknown
  double slice_thickness = 0;                   ///< of a slice in plane strain [m]; 0: the target is not a slice
  std::size_t unbuilt_mechanisms = 0;           ///< listed mechanisms that this version does not have
};

/// One mesh of the model.
struct MeshScale {
  Eigen::MatrixXd outermost;       ///< (2, 3): least and greatest coordinates of the whole target [m], NaN across a slice; or empty
  double liquid_element_size = 0;  ///< [m]
  double numerical_viscosity = 0;  ///< that acts on this mesh [Pa s]
};

/// A number of a mechanism between two values, for a score test.
struct KeyDifference {
  std::string mechanism, key;         ///< "beam_profile", "offset_z"
  double off = 0, low = 0, high = 0;  ///< the value that switches it off and the two at which it is run; `low` may be `off`
  bool like_the_mesh = false;         ///< a coarse mesh has the same effect
};

class Simulator;

/// A case with further gauges and beam energies, for planning an experiment.
struct PlannedCase {
  std::unique_ptr<Simulator> simulator;
  std::size_t own_sensors = 0;
  std::vector<std::string> gauges;    ///< a description of each further gauge
  std::vector<std::string> energies;  ///< a description of each further condition
};

/// The true model. Every method is a function of the case and the arguments alone and safe from several threads.
class Simulator {
 public:
  virtual ~Simulator() = default;

  [[nodiscard]] virtual const std::string& name() const = 0;
  /// Parameters, conditions, sensors, times and unit. It needs neither a mesh nor a connection.
  [[nodiscard]] virtual const ModelShape& shape() const = 0;
  [[nodiscard]] virtual const Capabilities& capabilities() const = 0;
  /// One run. A failure of the run is the record's message; exceptions are for the user's and our own mistakes.
  /// Errors: InputError for a mesh or a gauge that cannot be made; Unreachable; Interrupted.
  [[nodiscard]] RunRecord run(const RunRequest& request) const;
  /// The mean of one run in double precision; `wanted` is not looked at. Errors: as run.
  [[nodiscard]] virtual Prediction evaluate(const RunRequest& request) const = 0;
  /// The relative cost of a run, 1 for a run of the case's own mesh.
  [[nodiscard]] virtual double cost(const RunRequest&) const { return 1; }

  /// Mechanisms that the case offers to a diagnosis.
  [[nodiscard]] virtual std::vector<ParameterGroup> offered() const = 0;
  /// Terms by which a diagnosis describes missing physics that has no name.
  [[nodiscard]] virtual std::vector<ParameterGroup> terms() const { return {}; }
  /// `threads`: of this call, for what a single run gains by them. Errors: InputError for a mesh or a gauge that cannot be made; Unreachable.
  [[nodiscard]] virtual Description describe(int threads = 1) const = 0;
  [[nodiscard]] virtual SimulatorIdentity identity() const = 0;
  /// The resolved tables of the case that the model reads.
  [[nodiscard]] virtual Json echo() const = 0;
  /// What inference needs to know about this model in particular.
  [[nodiscard]] virtual InferenceHints hints() const { return {}; }

  /// The `simulate` verb. Errors: NumericsError of a run that fails; InputError for what the model does not have (fields, a mean).
  [[nodiscard]] virtual Simulated simulate(const SimulateCall& call) const = 0;

  /// Whether `gradient` is available.
  [[nodiscard]] virtual bool has_gradient() const { return false; }
  /// The gradient of sum_i weights_i mean_i(theta) with respect to theta, (n_parameters).
  [[nodiscard]] virtual Eigen::VectorXd gradient(std::span<const double> theta, std::span<const double> weights) const;
  /// The values that the number of a parameter may have at all; a server of the model refuses others.
  [[nodiscard]] virtual Range range(const Parameter&) const { return {}; }

  /// The number of a parameter in the tables of the case, which `simulate` takes in place of its nominal value; nothing: it takes the nominal value.
  [[nodiscard]] virtual std::optional<double> table_value(const Parameter&) const { return std::nullopt; }

  /// Of a model with a mesh: the mesh of a request.
  [[nodiscard]] virtual MeshScale mesh_scale(const RunRequest&) const { return {}; }
  /// Moves a gauge along its direction in a request by a distance [m]. False: the model has no gauges to move.
  [[nodiscard]] virtual bool move_gauge(RunRequest&, std::size_t sensor, double by) const;
  /// The numbers of mechanisms that score tests look at on the mesh of a request.
  [[nodiscard]] virtual std::vector<KeyDifference> score_test_keys(const RunRequest&) const { return {}; }
  /// The target, where there is one to be drawn.
  [[nodiscard]] virtual std::optional<TargetView> target() const { return std::nullopt; }
  /// Writes the mesh with its sets. Errors: InputError where the model has none, or the file cannot be written.
  virtual void write_mesh(const std::filesystem::path& path) const;
  /// The case with up to `gauges` further gauges and with conditions at these multiples of the beam energy. Null: the model cannot be planned with.
  [[nodiscard]] virtual std::optional<PlannedCase> planned(int gauges, const std::vector<double>& energies) const;

 protected:
  /// Outputs::totals and Outputs::energy_balance of a run, into `record`. Errors: NumericsError and InputError of a run that fails.
  virtual void add_energies(const RunRequest& request, RunRecord& record) const;
};

/// What a simulator takes from the rest of the case and from the program.
struct SimulatorSettings {
  int pulses = 8;                           ///< number of pulse energies in a mean
  double energy_sd = 0.015;                 ///< relative standard deviation of the energy from pulse to pulse
  const std::atomic<bool>* stop = nullptr;  ///< becomes true when the program is requested to stop
};

}  // namespace calomel
