#pragma once
/// The equation of keller_miksis.hpp for numbers and for vectors of them. Without includes, and inlined wherever it is used, so that kernels of every instruction set may take
/// it in.

namespace calomel {

/// R'' [m/s^2] of a bubble of radius r [m] that grows with v [m/s] in a liquid of pressure p above ambient, its gas being at the absolute pressure `gas` [Pa].
/// Bubble: has the numbers of KellerMiksis.
template <class Bubble, class V>
[[gnu::always_inline]] inline V bubble_acceleration(const Bubble& b, V r, V v, V p, V gas) {
  const V mach = v / b.sound_speed, tension = 2 * b.surface_tension / r, drag = 4 * b.viscosity / r;
  const V surface = gas - tension - drag * v;
  // dp_B/dt = (-3 kappa gas + tension + drag v) v/R - drag R''; its last part joins the inertia.
  const V change = (-3 * b.polytropic * gas + tension + drag * v) * v / r;
  const V push = (1 + mach) * (surface - b.ambient - p) + r / b.sound_speed * change;
  return (push / b.density - 1.5 * v * v * (1 - mach / 3)) / ((1 - mach) * r + 4 * b.viscosity / (b.density * b.sound_speed));
}

/// Square of the fastest rate at which the bubble changes now [1/s^2]: of the gas's spring, of the push, of the motion and of the drag.
template <class Bubble, class V>
[[gnu::always_inline]] inline V bubble_rate_squared(const Bubble& b, V r, V v, V p, V gas) {
  const V difference = gas - b.ambient - p, r2 = b.density * r * r, motion = 3 * v / r, drag = 4 * b.viscosity / r2;
  return (3 * b.polytropic * gas + (difference < 0 ? -difference : difference)) / r2 + motion * motion + drag * drag / 4;
}

}  // namespace calomel
