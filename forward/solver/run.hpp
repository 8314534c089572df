#pragma once
/// The arrays of one run (or of a group that fills the lanes) and the phases of its step. A step is: every block; then the
/// shared nodes and those with a rule; then, where the steel is damped by its nodes, every node. The phases may be spread over
/// threads in any way; the result does not depend on it.
#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <iosfwd>
#include <vector>

#include "forward/solver/explicit_solver.hpp"
#include "forward/solver/packed_mesh.hpp"

namespace calomel {

inline constexpr double unlimited_cutoff = 1e30;  ///< [Pa] never reached, finite in single precision

/// Whether wetted faces may come apart in the run: no strain below 1 reaches a cutoff above the bulk modulus.
inline bool faces_may_part(const RunSetup& s) { return !s.slip_strength.empty() || s.wetted_cutoff < s.liquid.bulk_modulus; }
inline constexpr std::size_t node_chunk = 512;  ///< nodes that a thread advances at a time
inline std::size_t node_chunks(std::size_t nodes) { return (nodes + node_chunk - 1) / node_chunk; }

/// Volume of steel and of liquid that each mesh node carries, an eighth of each element [m^3].
struct NodalVolumes {
  std::vector<double> steel, liquid;
};

/// The numbers of one step: those of the blocks that take every step, and those of the slow ones, which take every m-th.
template <class R>
struct StepPair {
  StepData<R> fast, slow;
  bool outer;          ///< the slow ones are at work
  std::size_t parity;  ///< of the step's number: energies are kept until the step after the next, so that they may be summed while that begins
};

template <class R>
class Run {
 public:
  /// All arguments but `options` outlive the run.
  Run(const PackedMesh<R>& packed, const Mesh& mesh, const NodalVolumes& volumes, const RunSetup& setup, const SolveOptions& options, double time_step,
      int subcycles = 1);

  [[nodiscard]] std::size_t block_count() const { return blocks_.size(); }
  /// Chunks of nodes of the second phase; those of slow blocks alone come last and only matter at outer steps.
  [[nodiscard]] std::size_t chunk_count(bool outer) const { return plain_chunks_ + rule_chunks_ + (outer ? slow_chunks_ : 0); }
  [[nodiscard]] int subcycles() const { return subcycles_; }
  [[nodiscard]] std::size_t scratch_size() const { return scratch_rows_ * 2 * packed_.width() + 64; }
  [[nodiscard]] bool damps_nodes() const { return !motion_factor_.empty() || !branches_.empty(); }

  /// The numbers of step n; `scratch` is the calling thread's.
  [[nodiscard]] StepPair<R> step(std::int64_t n, R* scratch) const;
  void advance_block(std::size_t block, const StepPair<R>& step);
  void advance_chunk(std::size_t chunk, const StepPair<R>& step);
  /// Damping of the nodes' motion and the steel's relaxing branches, on one of `parts` equal parts of the nodes.
  void damp_nodes(std::size_t part, std::size_t parts);
  [[nodiscard]] bool drags_slip() const { return !setup_.slip_drag.empty(); }
  /// Drag of the mercury along wetted faces, after damp_nodes.
  void drag_slip();
  /// Energies of step n, the last one done, summed in a fixed order; of slow blocks at outer steps only.
  [[nodiscard]] EnergyTerms energies(std::int64_t n) const;

  /// sum_k weights_k . u(nodes_k) of a lane.
  [[nodiscard]] double observe(const ObservationRow& row, std::size_t lane) const;
  /// The whole target at step n; the pressure of a liquid law of its own is that of the step before.
  [[nodiscard]] FieldSnapshot snapshot(std::int64_t n, bool motion_alone) const;
  /// Errors: NumericsError naming step, node and element where a displacement is not finite or beyond a metre.
  void check_finite(std::int64_t n) const;
  /// Greatest effective stress [Pa] that any steel element has seen, and that mesh element; runs with an energy balance only.
  [[nodiscard]] std::pair<double, std::int32_t> greatest_stress() const;
  /// Time that the liquid has been at its cutoff, the mean over its volume [s]; runs with an energy balance only, else 0.
  [[nodiscard]] double time_at_cutoff() const;

  /// Everything that a step changes, as bytes.
  void save(std::ostream& out) const;
  void restore(std::istream& in);

  /// For the estimate of the stable step: (K + C / dt) x against the mass, and its inner product. Rows as u.
  /// `liquid_alone`: without the steel's stiffness, its mass remains.
  void apply_operator(const AlignedArray<R>& x, AlignedArray<R>& result, int threads, bool liquid_alone = false) const;
  [[nodiscard]] std::vector<double> dot(const AlignedArray<R>& a, const AlignedArray<R>& b) const;  ///< (lanes), with the mass of faces that are apart
  [[nodiscard]] std::size_t row_count() const { return mass_.size(); }
  [[nodiscard]] const PackedMesh<R>& packed() const { return packed_; }

 private:
  [[nodiscard]] bool is_stressed() const { return !setup_.initial_stress.empty() || !setup_.thermal_strain.empty(); }
  [[nodiscard]] bool is_slow(std::size_t block) const { return block >= packed_.layout.first_slow_block; }
  void set_loads(StepData<R>& s, std::int64_t now, std::int64_t before) const;
  void make_masses(const NodalVolumes& volumes);
  void make_blocks();
  void make_rules(bool heated_rear);
  void make_branches();
  void damp_motion(std::size_t begin, std::size_t end);
  void relax(std::size_t begin, std::size_t end);
  void sum_branches(std::size_t begin, std::size_t end);
  void make_law(std::size_t block);
  /// What the block has of a stress before the run and of heat in the steel.
  void make_stress(std::size_t block);
  /// What rules have beyond the base model: pairs that may come apart, pressure behind the rear face.
  void make_extras();
  /// -trace/3 of the stress before the run of a mesh element [Pa].
  [[nodiscard]] double initial_pressure(std::size_t element) const;
  /// Strain of a mesh element's centre now, of the displacements alone (Green's in runs of finite strain) [-].
  [[nodiscard]] Eigen::Matrix3d steel_strain(std::size_t element) const;
  void remember_strain();
  /// A law's error at a point of a block, with its place.
  [[nodiscard]] NumericsError located(const NumericsError& error, std::size_t block, std::size_t point) const;
  void start_from(const std::vector<Vec3>& field, AlignedArray<R>& to);
  [[nodiscard]] double ramp(double time) const;
  void fill_elements(FieldSnapshot& fields, double share) const;
  /// The same of the liquid element at a place of a block.
  [[nodiscard]] double time_at_cutoff(std::size_t block, std::size_t slot) const;

  /// A block's law, as the kernel's hook finds it.
  struct LawOfBlock {
    const LiquidLaw* law;
    const Run* run;
    std::size_t block;
  };
  static void advance_law(const void* law_of_block, const LiquidPoints& points);

  const PackedMesh<R>& packed_;
  const Mesh& mesh_;
  const RunSetup& setup_;
  const KernelTable<R>& kernel_;
  double dt_;
  int subcycles_;  ///< steps in one of the slow blocks
  Keep keep_;      ///< what the blocks remember
  StepData<R> base_{};
  std::vector<double> mass_;  ///< by solver node [kg]
  std::vector<double>
      parted_mass_;  ///< the same, the least that acts in any direction where faces are apart: without the film that has gone to the other side [kg]
  std::vector<double> motion_factor_;  ///< by solver node; empty: no damping of the motion
  AlignedArray<R> inverse_mass_, u_, v_, outbox_;
  std::vector<AlignedArray<R>> p0_, state_;
  std::vector<AlignedArray<R>> initial_, thermal_, trace_;              ///< by block, of stressed runs
  AlignedArray<R> strength_, hold_, open_, rear_initial_, resistance_;  ///< by rule, of runs that have them
  std::vector<AlignedArray<double>> memory_;                            ///< of a liquid law of its own
  std::vector<LawOfBlock> laws_;                                        ///< by block, where there is such a law
  std::vector<BlockData<R>> blocks_;
  std::vector<SpecialData<R>> rules_;
  std::size_t scratch_rows_ = 0, plain_chunks_ = 0, rule_chunks_ = 0, slow_chunks_ = 0;
  std::array<std::vector<EnergyTerms>, 2> energies_;  ///< by parity of the step: of blocks, then of chunks
  std::vector<double> damped_;                        ///< energy taken by damp_motion, by stretch of the nodes [J]
  double dragged_ = 0;                                ///< by drag_slip [J]
  std::vector<AlignedArray<R>> branch_;               ///< x of each relaxing branch of the steel
  AlignedArray<R> relaxing_;                          ///< sum of share times x
  std::vector<Branch<R>> branches_;
};

extern template class Run<float>;
extern template class Run<double>;

}  // namespace calomel
