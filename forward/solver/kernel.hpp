#pragma once
/// What the inner loops take. They are compiled once for each instruction set and chosen at run time.
///
/// Two ways to fill the SIMD lanes: lanes are elements (one run: node rows are x, y, z, 0), or lanes are runs (eight runs
/// of one mesh that differ in pulse energy: node rows are x[8], y[8], z[8], geometry is broadcast).
#include <cstddef>
#include <cstdint>

#include "forward/solver/layout.hpp"
#include "forward/solver/liquid_points.hpp"

namespace calomel {

inline constexpr int run_lanes = 8;

/// What blocks remember from one step to the next.
enum class Keep : std::uint8_t {
  nothing,
  rate,     ///< what a viscosity needs that depends on the sign of the rate
  energies  ///< what the energy balance needs, too; lanes as elements only
};

/// Lane vectors of state per liquid element. Keep::rate: volumetric strain of the last step, and 1 once the element has been at the cutoff, else 0.
/// Keep::energies: strain and viscous pressure of the last step (with a law of its own: the whole pressure), the hourglass amplitudes and the time
/// spent at the cutoff [s]. A steel element keeps the square of its greatest effective stress then [Pa^2].
inline constexpr int rate_state = 2, energy_state = 15, steel_state = 1;
inline constexpr int state_time_at_cutoff = 14;
constexpr int liquid_state(Keep keep) { return keep == Keep::energies ? energy_state : keep == Keep::rate ? rate_state : 0; }

/// How an element is written down.
enum class Form : std::uint8_t {
  parallelepiped,  ///< three gradients, no coupling of hourglass and linear modes
  general,
  plane,  ///< plane strain with one element across: four corners, each of which represents two; lanes as runs only
  dense,  ///< steel only: any stiffness of the modes 1..7, for elements that check the fast ones
  finite  ///< finite strain: the terms of `general`, measured in the reference configuration
};

/// Energies and works of a step, summed over a block or a boundary [J].
struct EnergyTerms {
  double kinetic = 0;                              ///< 1/2 v- M v+
  double liquid = 0;                               ///< stored in the liquid
  double hourglass = 0;                            ///< stored in the liquid's hourglass modes
  double steel = 0;                                ///< stored in the steel
  double dissipated = 0;                           ///< by viscosity, since the last step
  double heat = 0;                                 ///< put in by the pulse, since the last step
  double boundary_before = 0, boundary_after = 0;  ///< work on the surroundings by the half steps before and after this instant
  double damped_after = 0;                         ///< taken from the motion after this instant
  double apart = 0;                                ///< stored between faces that are apart; part of what `dissipated` has taken so far
  void add(const EnergyTerms& t) {
    kinetic += t.kinetic;
    liquid += t.liquid;
    hourglass += t.hourglass;
    steel += t.steel;
    dissipated += t.dissipated;
    heat += t.heat;
    boundary_before += t.boundary_before;
    boundary_after += t.boundary_after;
    damped_after += t.damped_after;
    apart += t.apart;
  }
};

/// A liquid law of its own, as the kernel calls it.
struct LawHook {
  void (*advance)(const void* law, const LiquidPoints& points) = nullptr;  ///< null: Riemer's law
  const void* law = nullptr;
  double* memory = nullptr;  ///< (2 + state size, points): strain and pressure one step earlier, then the law's state
  std::size_t points = 0;    ///< of the block: elements x lanes, padding included
};

/// One block as the kernel sees it. Geometry per element: liquid parallelepiped b[9] V h; liquid b[21] V h X[12];
/// steel parallelepiped b[9] V K[45] L[6]; steel b[21] V X[12] K[45] L[6]; plane liquid b[6] V X[2] h; plane steel b[6] V X[2] K[3];
/// dense steel V K[231], the upper triangle by rows over (component, mode); with lanes as elements in groups [term][lane].
template <class R>
struct BlockData {
  bool liquid;
  Form form;
  std::int32_t groups;  ///< groups of lanes (elements), or elements (runs)
  const R* geometry;
  const std::uint16_t* connectivity;  ///< (groups, 8, lanes) or (elements, 8), of plane ones 4
  const R* p0;                        ///< heating pressure at full pulse and energy 1 [Pa], per element
  R* state;                           ///< (groups, liquid_state or steel_state, lanes), null where nothing is kept
  std::int32_t first_node, interior;
  const NodeRange* ranges;
  std::int32_t range_count;
  const std::int32_t* shared;
  std::int32_t shared_count;
  std::size_t outbox;
  LawHook law;
  const R* size =
      nullptr;  ///< liquid: shortest edge per element [m], as p0; with Keep::nothing `collapse` times it adds to the bulk modulus, null: nothing does
  // Stressed blocks only, all null in the base model:
  const R* initial =
      nullptr;  ///< liquid: pressure before the run [Pa], per element; steel: strain of the stress before the run, xx yy zz xy yz zx [-], as the geometry
  const R* thermal = nullptr;  ///< steel: alpha dT at full pulse and energy 1 [-], per element
  R* trace = nullptr;          ///< steel, with an energy balance: trace of the stress one step earlier [Pa], per element
};

template <class R>
struct SpecialData {
  std::int32_t node, partner;
  std::uint8_t fixed_node, fixed_partner;
  std::int32_t normals;
  R normal[3][3];
  R mass_node, mass_partner;
  R film;       ///< of mass_node, what moves along the normal with the steel where the pair may come apart [kg]
  R rear_area;  ///< 0 = not on the rear face
  R rear_normal[3];
  R rear_p0;       ///< heating pressure of the mercury behind the face at full pulse [Pa]
  R load_area[3];  ///< end_stress acts on this area [m^2]
};

/// What the rules of boundary nodes have beyond the base model, in their order; all null in the base model.
template <class R>
struct RuleExtras {
  const R* strength = nullptr;      ///< pull at which the pair comes apart, tensile strength times area [N]; null: the base model
  const R* hold = nullptr;          ///< pull on either while the pair is apart [N]
  R* open = nullptr;                ///< (rules, lanes) 1 while the pair is apart, else 0
  const R* rear_initial = nullptr;  ///< pressure before the run of the mercury behind the rear face [Pa]
  const R* resistance = nullptr;    ///< (rules, 2) of an open pair to its gap's growth, and to its closing [N s/m]; null: none
  bool films = false;               ///< some pair has a film
};

/// A relaxing branch of the steel.
template <class R>
struct Branch {
  R* x;                ///< node rows, of its spring [m]
  double share, time;  ///< RelaxingBranch
};

template <class R>
struct StepData {
  R* u;                   ///< node rows, displacement [m]
  R* v;                   ///< node rows, velocity [m/s]
  const R* inverse_mass;  ///< per solver node [1/kg]
  R* outbox;
  const std::size_t* outbox_end;            ///< per shared node: one past the rows that count at this step
  R outbox_scale;                           ///< on what a block leaves in the outbox: 1, or the fast steps in a slow one
  R* scratch;                               ///< one thread's room for displacements and forces of a block
  R dt, kick;                               ///< kick = dt, half of it in the first step
  R bulk_modulus, cutoff, beta, hourglass;  ///< K [Pa], sigma_c [Pa], eta/K [s], coefficient K [Pa]
  R quadratic;                              ///< rho (b2 h)^2 [Pa s^2]
  R collapse;                               ///< b rho c, times an element's size: its resistance to closing [Pa s/m]
  R rear_give, rear_push;                   ///< rear face: give p' = push v_n; 1 - r and (1 + r) rho c
  R rear_late, rear_early;                  ///< share of v_n after the step, and of v_n before it over that; 1/2 and 1 at r = 0
  R lambda, mu;                             ///< of the steel
  R steel_beta;                             ///< stiffness-proportional damping of the steel [s]
  const R* relaxing;                        ///< node rows, what the steel's branches add to the displacement that its forces answer [m]; null: none
  const Branch<R>* branches;                ///< one a branch
  int branch_count;
  RuleExtras<R> extras;
  alignas(64) R load[run_lanes];         ///< share of p0 that has been put in, times pulse energy
  alignas(64) R load_before[run_lanes];  ///< the same one step earlier
  alignas(64) R end_stress[run_lanes];   ///< [Pa], tension positive
};

template <class R>
struct KernelTable {
  const char* name;  ///< instruction set
  int lanes;         ///< elements at a time
  /// Forces of a block, interior nodes advanced, forces on shared nodes left in the outbox. Keep::energies adds to `energy`.
  void (*element_block)(const BlockData<R>&, const StepData<R>&, Keep keep, EnergyTerms* energy);
  void (*run_block)(const BlockData<R>&, const StepData<R>&, Keep keep);
  /// Shared nodes without a rule, [begin, end) of layout.plain.
  void (*element_plain)(const Layout&, std::size_t begin, std::size_t end, const StepData<R>&, bool energy_balance, EnergyTerms*);
  void (*run_plain)(const Layout&, std::size_t begin, std::size_t end, const StepData<R>&);
  /// Nodes with a rule, [begin, end) of `rules`.
  void (*element_special)(const Layout&, const SpecialData<R>* rules, std::size_t begin, std::size_t end, const StepData<R>&, bool energy_balance,
                          EnergyTerms*);
  void (*run_special)(const Layout&, const SpecialData<R>* rules, std::size_t begin, std::size_t end, const StepData<R>&);
};

/// Corners of an element.
constexpr std::size_t corner_count(Form form) { return form == Form::plane ? 4 : 8; }

/// The fastest table that this processor can run; the environment variable CALOMEL_ISA (baseline, avx2, avx512) overrides.
template <class R>
const KernelTable<R>& kernels();

/// Numbers of geometry terms per element.
constexpr int geometry_terms(bool liquid, Form form) {
  if (form == Form::plane) return 6 + 1 + 2 + (liquid ? 1 : 3);
  if (form == Form::dense) return 1 + 231;
  const bool parallelepiped = form == Form::parallelepiped;
  const int gradients = parallelepiped ? 9 : 21, x = parallelepiped ? 0 : 12;
  return gradients + 1 + x + (liquid ? 1 : 45 + 6);
}

}  // namespace calomel
