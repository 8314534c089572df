#pragma once
/// The explicit solver: central differences with a lumped mass on hexahedra of elastic steel and of a liquid that gives
/// way in tension (physics.md section 1).
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "forward/material/linear_elastic.hpp"
#include "forward/material/riemer.hpp"
#include "forward/mesh/mesh.hpp"
#include "forward/solver/liquid_law.hpp"
#include "forward/solver/load.hpp"
#include "forward/solver/reentrant_edges.hpp"
#include "forward/solver/subcycles.hpp"
#include "forward/solver/thread_shares.hpp"

namespace calomel {

/// `[solver]`.
struct SolverOptions {
  std::string precision = "double";
  double time_step_safety = 0.95;
  int subcycles = 1;
  std::string rear_reference = "heated";
  std::string kinematics = "small";
  std::string steel_element = "assumed_strain";
  bool energy_balance = true;
  double checkpoint = 120;
  template <class V>
  void visit(V& v) {
    v("precision", precision, {.doc = "arithmetic of the time loop", .choices = {"single", "double"}});
    v("time_step_safety", time_step_safety, {.range = between(0.05, 1), .doc = "share of the stable step that is used"});
    v("subcycles", subcycles, {.range = between(1, 8), .doc = "mercury away from the steel is advanced at every so many steps at most; 1 = at every step"});
    v("rear_reference", rear_reference,
      {.doc = "mercury behind a non-reflecting rear face: equally heated, or unheated (zero)", .choices = {"heated", "zero"}});
    v("kinematics", kinematics,
      {.doc = "strain of the elements: of small displacements, or Green's in the reference configuration", .choices = {"small", "finite"}});
    v("steel_element", steel_element,
      {.doc = "assumed strain, exact in bending, or the selectively reduced B-bar element that checks it (locks in thin walls; small strain only)",
       .choices = {"assumed_strain", "b_bar"}});
    v("checkpoint", checkpoint,
      {.unit = "s", .range = at_least(0), .doc = "wall time between the checkpoints of simulate, from which an interrupted run resumes; 0 = none"});
    v("energy_balance", energy_balance, {.doc = "energy balance of every step in simulate (a seventh to a third slower)"});
    v.renamed("booking", "solver.energy_balance");
  }
};

/// A linear functional of the nodal displacements, sum_k weights_k . u(nodes_k).
struct ObservationRow {
  std::vector<NodeId> nodes;
  std::vector<Vec3> weights;
};

/// A spring in series with a dashpot beside the steel's own stiffness K (Maxwell): force share K x, dx/dt = v - x / time.
struct RelaxingBranch {
  double share;  ///< of its spring over the steel's stiffness [-]
  double time;   ///< [s]
};

inline constexpr double greatest_film = 0.6;  ///< of RunSetup::wall_film, over the mass of the node that it is taken from

/// The physical state of affairs in one run (or in a group of up to eight that differ in pulse energy).
struct RunSetup {
  double steel_density = 0, liquid_density = 0;  ///< [kg/m^3]
  LinearElastic steel{};
  Riemer liquid{};
  double hourglass = MercuryOptions{}.hourglass;                    ///< liquid hourglass coefficient [-]
  double quadratic_viscosity = 0;                                   ///< b2 [-]
  double collapse_viscosity = MercuryOptions{}.collapse_viscosity;  ///< b [-]
  std::shared_ptr<const LiquidLaw> liquid_law;                      ///< in place of Riemer's; null: Riemer's with the numbers of `liquid`
  double steel_mass_damping = 0;                                    ///< a of a M v in the steel [1/s]
  double steel_stiffness_damping = 0;                               ///< b of b K v in the steel [s]
  std::vector<RelaxingBranch> steel_branches;                       ///< beside the steel's stiffness, which is that of slow motion; empty: none
  double rear_coefficient = 0;               ///< r of (1 - r) p' = (1 + r) rho c v_n at the rear face: 0 lets waves out, 1 holds, -1 frees
  std::vector<double> p0;                    ///< per mesh element, at energy 1 [Pa]; empty: none
  std::function<double(const Vec3&)> p0_at;  ///< the same at a point, for the rear face
  double pulse_length = 0;                   ///< [s]
  History end_stress;                        ///< [Pa], tension positive; empty: none
  std::vector<Vec3> initial_displacement;    ///< per mesh node [m]; empty: none
  std::vector<Vec3> initial_velocity;        ///< per mesh node at t = 0 [m/s]; empty: rest
  /// Stress before the run, which is there without any displacement: per mesh element xx yy zz xy yz zx, tension positive [Pa]; of the mercury only the
  /// pressure, -trace/3, counts, and it is that of the mercury behind a non-reflecting rear face, too. Empty: none.
  std::vector<std::array<double, 6>> initial_stress;
  /// Free strain of heated steel, alpha dT of sigma = C : (epsilon - alpha dT 1), constant in an element: per mesh element at full pulse and energy 1, 0 in
  /// the mercury [-]; it rises as p0 does. Empty: none.
  std::vector<double> thermal_strain;
  /// Traction, tension positive, at which the mercury gives way at a wetted face [Pa]: steel and mercury of a slip pair come apart there, pull on each other
  /// with that traction while apart, and meet again, without rebound, when the gap is gone. Pairs of more than one normal, along edges, remain together.
  /// Infinite: none comes apart, and half a layer of mercury elements moves with the wall when the mercury has given way.
  double wetted_cutoff = std::numeric_limits<double>::infinity();
  /// Mercury that remains on a wetted face when a pair comes apart [m]: the cavity opens that far from the wall. At most `greatest_film` of the half element
  /// that the face's nodes carry. Below 0 the wall is the lighter for it, which no wall is, so that an estimate near 0 has two sides.
  double wall_film = 0;
  /// A face that holds less than the mercury does: traction at which it comes apart, per row of Mesh::slip, infinite: as the mercury [Pa]. Apart it carries no
  /// normal traction but slip_hold, 0 where that is empty [Pa]. Empty: none.
  std::vector<double> slip_strength, slip_hold;
  /// Time constants of a pair that comes apart at the wetted_cutoff [s]: beyond that traction it pulls with K tau / l times the rate of its gap, tau being
  /// parting_time while the gap grows and meeting_time while it closes, l the thickness of mercury that moves with the wall (half an element). 0: at once.
  double parting_time = 0, meeting_time = 0;
  /// What nodes carry and lose beside the materials, by mesh node: mass [kg], and drag of their motion [kg/s]; empty: none. Drag of the motion of mercury along
  /// steel, by row of Mesh::slip [kg/s]; empty: none.
  std::vector<double> node_mass, node_damping, slip_drag;
  std::vector<double> energies{1.0};    ///< relative pulse energy of each run, 1 to 8
  double end = 0, output_interval = 0;  ///< [s]

  /// b rho c, times the size of a liquid element its resistance to closing [Pa s/m]; 0 where no strain below 1 reaches the cutoff.
  [[nodiscard]] double collapse_resistance() const {
    return !(liquid.tensile_cutoff < liquid.bulk_modulus) ? 0 : collapse_viscosity * std::sqrt(liquid.bulk_modulus * liquid_density);
  }
  /// Stiffness of the steel in fast motion over that in slow motion.
  [[nodiscard]] double steel_stiffening() const {
    double sum = 1;
    for (const auto& branch : steel_branches) sum += branch.share;
    return sum;
  }
  /// Stiffness of the liquid from which the time step follows: the bulk modulus, or what a law of its own may come to where that is more [Pa].
  [[nodiscard]] double liquid_stiffness() const { return std::max(liquid.bulk_modulus, liquid_law ? liquid_law->greatest_stiffness() : 0.0); }
};

/// A picture of the whole target at one instant.
struct FieldSnapshot {
  double time = 0;                       ///< [s]
  std::vector<Vec3> displacement;        ///< per mesh node [m]
  std::vector<Vec3> velocity;            ///< per mesh node [m/s]
  std::vector<double> pressure;          ///< per mesh element, compression positive; with the two below empty in a picture of motion alone [Pa]
  std::vector<double> effective_stress;  ///< per mesh element, von Mises at the centre, 0 in the liquid [Pa]
  std::vector<double> time_at_cutoff;  ///< per mesh element, time that the liquid has spent at its cutoff so far; runs with an energy balance only, else 0 [s]
};

/// Where a long run leaves what it needs to go on, and how often.
struct Checkpoint {
  std::filesystem::path path;                              ///< empty: none
  double every_seconds = 120;                              ///< wall time
  std::string identity;                                    ///< of everything that decides the run; a file of another identity is an error
  std::function<void(std::int64_t fields)> before_saving;  ///< called with the number of snapshots handed out so far
  bool keep = false;  ///< a run that came to its end leaves a last one, from which its results are given again without a step; else it leaves none
  /// The run goes on from this step, this many snapshots done; at its end when `finished`.
  std::function<void(std::int64_t step, std::int64_t fields, bool finished)> on_resume;
};

struct SolveOptions {
  std::string precision = "double";
  std::string kinematics = "small";              ///< or finite
  std::string steel_element = "assumed_strain";  ///< or b_bar
  double time_step_safety = 0.95;
  int subcycles = 1;                              ///< steps in one of the mercury away from the steel, at most
  int subcycle_buffer = default_subcycle_buffer;  ///< layers of mercury beside the steel that take every step
  bool heated_rear = true;
  bool energy_balance = false;  ///< one run only
  bool every_step = false;      ///< observe at every step (every slow one) instead of every output interval
  int threads = 1;              ///< exactly so many, as far as there are blocks; see ExplicitSolver::useful_threads
  double field_interval = 0;    ///< 0 = no fields
  bool motion_alone = false;    ///< pictures of displacement and velocity alone: those of elements take as long as many steps
  std::function<void(const FieldSnapshot&)> on_field;
  std::function<void(double share)> on_progress;
  const std::atomic<bool>* stop = nullptr;  ///< checked at every output; saves the checkpoint and throws Interrupted
  Checkpoint checkpoint;
};

/// The options of a case as a run takes them.
SolveOptions solve_options(const SolverOptions& options);

struct SolveSummary {
  std::vector<double> times;         ///< of the observations [s]
  std::vector<double> observations;  ///< (run, row, time)
  std::int64_t steps = 0;
  double time_step = 0;                 ///< [s]
  int subcycles = 1;                    ///< steps in one of the mercury away from the steel
  double wall_seconds = 0;              ///< of the time loop
  double processor_seconds = 0;         ///< of the threads in it
  double element_steps_per_second = 0;  ///< elements x runs x steps / wall, slow ones counted at every step
  double energy_balance_error = 0;      ///< max |imbalance| / energy put in; NaN without it
  double hourglass_share = 0;           ///< greatest hourglass energy / energy put in
  double energy_in = 0;                 ///< by heat, end loads and the initial state [J]
  double dissipated = 0, radiated = 0;  ///< by viscosity; through the rear face [J]
  double greatest_stress = 0;           ///< highest effective stress of any steel element's centre; runs with an energy balance only, else 0 [Pa]
  Vec3 greatest_stress_at{};            ///< centre of that element [m]
  /// How long the mercury has been at its cutoff, the mean over its volume: sum_e V_e t_e / sum_e V_e with the time t_e of FieldSnapshot::time_at_cutoff at the
  /// end; runs with an energy balance only, else 0 [s]
  double time_at_cutoff = 0;
  std::int64_t resumed_from = 0;  ///< step of the checkpoint that the run went on from; 0: from the start
  std::string kernel;             ///< instruction set
};

/// A mesh made ready for runs. Building costs about a microsecond an element; runs may then share it from several threads.
class ExplicitSolver {
 public:
  /// `steel` fixes the elements' bending stiffness; a run with other moduli needs its own solver. `softening` is that of the
  /// steel elements at re-entrant edges; 0 leaves them as they are (and converges at first order).
  ExplicitSolver(const Mesh& mesh, const LinearElastic& steel, int threads = 1, double softening = reentrant_softening);
  ~ExplicitSolver();
  ExplicitSolver(ExplicitSolver&&) noexcept;

  /// Bound of the stable step from the worst element (of the liquid alone), before the safety factor [s]. Errors: NumericsError when nothing can move or it
  /// vanishes.
  [[nodiscard]] double element_step(const RunSetup& setup, bool liquid_alone = false) const;
  /// Stable step of the whole mesh (see stable_step.hpp), never below the bound from the elements [s].
  [[nodiscard]] double stable_step(const RunSetup& setup, const SolveOptions& options = {}) const;
  /// How the output interval is divided. Of the numbers of sub-cycles that `options` allow and the liquid's own stable step permits, the
  /// cheapest, 1 when none pays. Errors: NumericsError when there would be more than a million steps.
  [[nodiscard]] Stepping stepping(const RunSetup& setup, const SolveOptions& options) const;

  /// The number of threads, at most `most`, that such a run is fastest on: a small one has too little work for several.
  [[nodiscard]] ThreadChoice useful_threads(const RunSetup& setup, const SolveOptions& options, int most) const;

  /// Runs from the setup's initial state (rest unless given). `rows` observe displacements. Errors: NumericsError (step, time, place), Interrupted.
  [[nodiscard]] SolveSummary solve(const RunSetup& setup, std::span<const ObservationRow> rows, const SolveOptions& options) const;

  [[nodiscard]] const Mesh& mesh() const;

 private:
  [[nodiscard]] StableSteps stable_steps(const RunSetup& setup, const SolveOptions& options) const;

  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace calomel
