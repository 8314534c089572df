#pragma once
/// The inner loop of BubblyLiquid, compiled for several instruction sets: the bubbles of several points at a time.
#include "base/instruction_set.hpp"
#include "forward/solver/liquid_points.hpp"

namespace calomel {

/// Numbers of a bubbly liquid: those of KellerMiksis and of Riemer by their names there, and what follows from them.
struct BubblyNumbers {
  double density, sound_speed, radius, ambient, polytropic, surface_tension, viscosity;
  double gas_at_rest;  ///< p_a + 2 sigma/R0 [Pa]
  double bulk_modulus, tensile_cutoff, liquid_viscosity;
  double alpha0, greatest_alpha;  ///< share of gas at rest, and at which a run stops [-]
  double coupling;                ///< dp/dR / (rho R) over R: 3 alpha0 K/(rho R0^3) [1/(m s^2)]
  double greatest_step;           ///< [s]
};

/// What stops a point.
struct BubbleFailure {
  enum Reason { none, vanished, too_violent, too_much_gas } reason = none;
  std::size_t point = 0;
  double radius = 0;  ///< [m]
};

struct BubbleKernel {
  /// Pressure and state of every point after the step, by the rule of advance_bubble (keller_miksis.hpp): sub-steps of classical Runge-Kutta, each point its
  /// own. At the first failure it returns.
  BubbleFailure (*advance)(const BubblyNumbers&, const LiquidPoints&);
};

/// For an instruction set that this processor has.
const BubbleKernel& bubble_kernel(InstructionSet isa);

}  // namespace calomel
