#pragma once
/// The built-in forward model: a case, its mesh and gauges, and the ensemble mean over pulse energies.
#include <filesystem>
#include <functional>
#include <memory>

#include "forward/target/ensemble.hpp"
#include "forward/target/forward_case.hpp"
#include "forward/model.hpp"
#include "forward/sensor/gauge.hpp"

namespace calomel {

/// eta of the case's mercury on a mesh [Pa s]: the case's own, or what the mesh needs where that is more.
[[nodiscard]] double regularising_viscosity(const ForwardCase& forward_case, const Mesh& mesh);

/// What `check` prints and every artefact may carry.
struct ModelDescription {
  std::size_t elements = 0, nodes = 0, slip_pairs = 0;
  double time_step = 0;  ///< [s], at the case's own parameters
  std::int64_t steps = 0;
  int subcycles = 1;         ///< steps in one of the mercury away from the steel
  double element_steps = 0;  ///< of one run; with sub-cycles in steps of all elements that would cost as much
  double viscosity = 0;      ///< eta [Pa s]
  bool mesh_decides_viscosity = false;
  double deposited_energy = 0;        ///< in the whole target [J]; 0 for an end_stress
  double slice_thickness = 0;         ///< in plane strain [m]
  double estimated_seconds = 0;       ///< of one run on one thread, at the rate that was measured for this size and precision
  int run_threads = 1;                ///< of those that the model may use, how many a single run takes
  double run_gain = 1;                ///< estimated, over one thread
  double estimated_mean_seconds = 0;  ///< of one ensemble mean on one thread
  double estimated_bytes = 0;
  std::vector<std::string> warnings;
  std::vector<std::string> notes;
};

class KeptStates;  // forward/kept_states.hpp

class BuiltInModel : public ForwardModel {
 public:
  /// `threads`: of one run at most, as many as it gains by (a campaign runs points side by side on one thread each).
  /// Errors: InputError for a mesh or gauge that cannot be made.
  explicit BuiltInModel(const ForwardCase& forward_case, EnsembleOptions ensemble = {}, int threads = 1);
  /// The same on a mesh that the caller made (jittered, deformed), which mechanisms then change; parameters of the geometry are refused.
  BuiltInModel(ForwardCase forward_case, EnsembleOptions ensemble, int threads, Mesh mesh);
  ~BuiltInModel() override;

  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override;

  /// Keeps the states that earlier pulses leave together with another model of the same mesh: a model with one more mechanism need not make them again.
  void share_states_with(const BuiltInModel& other);

  /// One run at energy 1 with the case's own tables for each condition; fields of the first. With several conditions each has a checkpoint of its own, see
  /// checkpoints(), which it keeps until all are finished: a run that was cut off goes on with the condition that was under way, and repeats none.
  struct Simulation {
    SolveSummary summary;
    std::vector<double> strain;  ///< (condition, sensor, time) [-]
  };
  /// `finished` is called after each condition with its number; steps, times and the share of the progress are of all.
  [[nodiscard]] Simulation simulate(const SolveOptions& options, const std::function<void(std::size_t condition)>& finished = {}) const;
  /// The files that simulate makes of `checkpoint`: itself, or with several conditions "checkpoint.0", ... in their order.
  [[nodiscard]] std::vector<std::filesystem::path> checkpoints(const std::filesystem::path& checkpoint) const;

  /// What a run reports of itself, beside the histories of its gauges; of the part that is modelled, as the energy balance is.
  struct RunTotals {
    double dissipated = 0;            ///< by viscosity to the end of the run, SolveSummary::dissipated [J]
    double time_at_cutoff = 0;        ///< of the mercury, the mean over its volume, SolveSummary::time_at_cutoff [s]
    double energy_balance_error = 0;  ///< SolveSummary::energy_balance_error [-]
  };
  /// Of one run at energy 1 with an energy balance at `theta` for each condition, (condition). Errors: NumericsError and InputError of a run that fails.
  [[nodiscard]] std::vector<RunTotals> totals(std::span<const double> theta) const;

  [[nodiscard]] ModelDescription describe() const;
  [[nodiscard]] const Mesh& mesh() const { return *mesh_; }
  [[nodiscard]] const std::vector<LocatedGauge>& gauges() const { return gauges_; }
  [[nodiscard]] const ForwardCase& forward_case() const { return case_; }
  [[nodiscard]] const EnsembleOptions& ensemble() const { return ensemble_; }

  /// The setup of a run at a case's numbers and one condition. Errors: NumericsError when they are outside a policy's reach.
  [[nodiscard]] RunSetup setup(const ForwardCase& at, const Mesh& mesh, std::size_t condition, std::vector<double> energies) const;

 private:
  /// The heat of the pulse, as the load of the run has it. Returns how many times the strength of [load] the condition is.
  double put_heat(RunSetup& s, const ForwardCase& at, const Mesh& mesh, const LoadOptions& load, std::size_t condition) const;

  /// The case at some parameters with the mesh, gauges and elements that it needs: its own where a parameter changes them.
  struct Place;
  [[nodiscard]] std::unique_ptr<Place> at(std::span<const double> theta) const;

  /// If a mechanism has motion of earlier pulses, puts that into the run's initial state; its gauges are then to be set to zero. Errors: as
  /// setup(), and those of the long run.
  bool start_from_what_is_left(RunSetup& s, const ForwardCase& at, const Mesh& mesh, const ExplicitSolver& solver, std::size_t condition) const;

  ForwardCase case_;
  EnsembleOptions ensemble_;
  int threads_;
  ModelShape shape_;
  std::unique_ptr<Mesh> mesh_;
  std::unique_ptr<Mesh> unchanged_mesh_;  ///< before mechanisms; only where a parameter changes what they do to it
  std::vector<LocatedGauge> gauges_;
  HeatingShape heating_;
  std::unique_ptr<ExplicitSolver> solver_;
  double front_ = 0;      ///< x of the outer front face [m], of a mesh from a file; others begin at 0
  bool remesh_ = false;   ///< a parameter changes the geometry
  bool regauge_ = false;  ///< a parameter changes where a gauge sits
  bool reheat_ = false;   ///< a parameter changes the shape of the deposition
  bool resteel_ = false;  ///< a parameter changes the steel's moduli
  std::shared_ptr<KeptStates> kept_states_;
};

/// The same model with elements of half the size (walls of a given number of elements get twice as many), one thread a run; null where the mesh comes
/// from a file and cannot be made finer.
std::unique_ptr<BuiltInModel> finer_model(const BuiltInModel& model);

}  // namespace calomel
