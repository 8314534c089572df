#pragma once
/// Voids in the mercury that take time to grow and to collapse: with the stretch beyond the cutoff x = e_v + (eta/K) de_v/dt - (p0 + sigma_c)/K,
///   alpha <- max(0, x + (alpha - x) exp(-dt/tau)), tau = growth_time where x > alpha, else collapse_time;   p = p0 - K (e_v - alpha) - eta de_v/dt.
/// Growth and collapse dissipate (-p - sigma_c) dalpha/dt = K (x - alpha) dalpha/dt >= 0; with both times 0 it is Riemer's law. Between mercury and a wall the
/// gap follows the same law in the half element of mercury that moves with the wall (RunSetup::parting_time). Off: both 0 (physics.md section 3).
///
/// Or voids that grow from nuclei against the inertia of the mercury about them, each as after Rayleigh where pressure and cutoff differ and Rddot is left out
/// [Schnerr2001]:
///   alpha = (R/a)^3,   dR/dt = sign(x - alpha) sqrt(2 |p + sigma_c| / (3 rho)),   p + sigma_c = -K (x - alpha),   a = (3/(4 pi))^(1/3) nuclei_spacing.
/// It dissipates, too, and is Riemer's law at a spacing of 0. A wall parts from the mercury at once, as in the base model.
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

/// Mercury of this law at points. State of a point: alpha, the void's share of the volume [-].
class KineticLiquid : public LiquidLaw {
 public:
  KineticLiquid(const Riemer& liquid, double growth_time, double collapse_time) : liquid_(liquid), growth_time_(growth_time), collapse_time_(collapse_time) {}

  [[nodiscard]] std::size_t state_size() const override { return 1; }
  void advance(const LiquidPoints& points) const override;

 private:
  Riemer liquid_;
  double growth_time_, collapse_time_;
};

/// Mercury with nuclei. State of a point: (alpha)^(1/3) [-].
class NucleatedLiquid : public LiquidLaw {
 public:
  NucleatedLiquid(const Riemer& liquid, double density, double nuclei_spacing);

  [[nodiscard]] std::size_t state_size() const override { return 1; }
  void advance(const LiquidPoints& points) const override;

 private:
  Riemer liquid_;
  double rate_;  ///< of the state, at a stretch of 1 beyond the void [1/s]
};

MechanismEntry cavitation_kinetics();

}  // namespace calomel
