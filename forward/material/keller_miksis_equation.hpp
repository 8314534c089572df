#pragma once
/// The equation of keller_miksis.hpp for numbers and for vectors of them. Without includes, and inlined wherever it is used, so that kernels of every
/// instruction set may take it in.

namespace calomel {

/// R'' [m/s^2] of a bubble of radius r [m] that grows with v [m/s] in a liquid of pressure p above ambient, its gas being at the absolute pressure `gas` [Pa].
/// Bubble: has the numbers of KellerMiksis.
template <class Bubble, class V>
[[gnu::always_inline]] inline V bubble_acceleration(const Bubble& b, V r, V v, V p, V gas) {
  // One division serves 1/r and the inertia; those by numbers of the liquid are done once for many bubbles.
  const double per_sound_speed = 1 / b.sound_speed, per_density = 1 / b.density;
  const V mach = v * per_sound_speed, inertia = (1 - mach) * r + 4 * b.viscosity * per_density * per_sound_speed, inverse = 1 / (r * inertia),
          per_r = inverse * inertia;
  const V tension = 2 * b.surface_tension * per_r, drag = 4 * b.viscosity * per_r;
  const V surface = gas - tension - drag * v;
  // dp_B/dt = (-3 kappa gas + tension + drag v) v/R - drag R''; its last part joins the inertia.
  const V change = (-3 * b.polytropic * gas + tension + drag * v) * v * per_r;
  const V push = (1 + mach) * (surface - b.ambient - p) + r * per_sound_speed * change;
  return (push * per_density - 1.5 * v * v * (1 - mach * (1.0 / 3))) * (inverse * r);
}

/// Square of the fastest rate at which the bubble changes now [1/s^2]: of the gas's spring, of the push, of the motion and of the drag.
template <class Bubble, class V>
[[gnu::always_inline]] inline V bubble_rate_squared(const Bubble& b, V r, V v, V p, V gas) {
  const V difference = gas - b.ambient - p, per_r2 = 1 / (r * r), drag = 2 * b.viscosity / b.density * per_r2;
  return (3 * b.polytropic * gas + (difference < 0 ? -difference : difference)) * (1 / b.density) * per_r2 + 9 * v * v * per_r2 + drag * drag;
}

}  // namespace calomel
