#pragma once
/// Mercury that stiffens under pressure: p = max((K/m) ((1 - e)^m - 1) - eta de_v/dt, -sigma_c), e = e_v - p0/K, the power law of Tait's form (Hayward 1967,
/// Br. J. Appl. Phys. 18, 965) with m = n + 2 for Tait's n = B/A + 1: strains are those of small displacements on the mesh at rest, so that the motion of the
/// liquid is in the exponent. A wave of strain e runs with c (1 - e)^((m - 1)/2). Off: m = 1 (physics.md section 3).
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

/// Mercury of this law at points, without state. Its stiffness K (1 - e)^(m - 1) has no bound of its own: that at `greatest_pressure` [Pa] is given to the
/// solver. Errors: LiquidPointError where that pressure is passed.
class StiffeningLiquid : public LiquidLaw {
 public:
  StiffeningLiquid(const Riemer& liquid, double exponent, double greatest_pressure)
      : liquid_(liquid), exponent_(exponent), greatest_pressure_(greatest_pressure) {}

  [[nodiscard]] double greatest_stiffness() const override;
  void advance(const LiquidPoints& points) const override;

 private:
  Riemer liquid_;
  double exponent_, greatest_pressure_;
};

MechanismEntry nonlinear_eos();

}  // namespace calomel
