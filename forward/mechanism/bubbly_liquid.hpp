#pragma once
/// Small gas bubbles in the mercury, alpha0 of its volume at rest: p = max(p0 - K (e_v - alpha + alpha0) - eta de_v/dt, -sigma_c),
/// alpha = alpha0 (R/R0)^3, R after Keller and Miksis under p. The bubbles of a point do not touch or drift, and the density
/// remains that of the liquid: stop at alpha > 0.1. Off: alpha0 = 0 (physics.md section 3).
#include "forward/material/keller_miksis.hpp"
#include "forward/mechanism/bubble_kernel.hpp"
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

/// Bubbly mercury at points. State of a point: R [m], dR/dt [m/s], and p0 one step earlier [Pa]. Within a step e_v and p0 run linearly in
/// time while p and R advance together, several points at a time (bubble_kernel.hpp). Errors: LiquidPointError where alpha > 0.1 or a collapse cannot be
/// followed.
class BubblyLiquid : public LiquidLaw {
 public:
  /// `liquid`: of the mercury without bubbles, its viscosity the regularising one; `bubble`: of density and sound speed of that mercury.
  BubblyLiquid(const Riemer& liquid, const KellerMiksis& bubble, double alpha0, InstructionSet isa = instruction_set());

  [[nodiscard]] std::size_t state_size() const override { return 3; }
  void initialise(std::span<const Vec3> centres, double* state, std::size_t stride) const override;
  void advance(const LiquidPoints& points) const override;

  static constexpr double greatest_alpha = 0.1;

 private:
  BubblyNumbers numbers_;
  const BubbleKernel* kernel_;
};

MechanismEntry bubbly_liquid();

}  // namespace calomel
