#pragma once
/// A gas bubble in a compressible liquid (Keller and Miksis 1980, J. Acoust. Soc. Am. 68, 628, eq. 1.2):
///   (1 - R'/c) R R'' + 3/2 R'^2 (1 - R'/3c) = (1 + R'/c)(p_B - p_a - p)/rho + R/(rho c) dp_B/dt,
///   p_B = (p_a + 2 sigma/R0)(R0/R)^(3 kappa) - 2 sigma/R - 4 mu R'/R,
/// radius R [m], pressure p of the liquid far away [Pa] counted from ambient p_a (absolute), p_B absolute. At p = 0 and R = R0
/// the bubble rests.
#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "forward/material/keller_miksis_equation.hpp"

namespace calomel {

struct KellerMiksis {
  double density;          ///< rho of the liquid [kg/m^3]
  double sound_speed;      ///< c of the liquid [m/s]; infinite: Rayleigh and Plesset
  double radius;           ///< R0, at rest [m]
  double ambient;          ///< p_a [Pa], absolute
  double polytropic;       ///< kappa [-]
  double surface_tension;  ///< sigma [N/m]
  double viscosity;        ///< mu, including the loss of heat [Pa s]

  struct State {
    double radius;  ///< R [m]
    double rate;    ///< R' [m/s]
  };

  /// Pressure of the gas [Pa], absolute.
  [[nodiscard]] double gas_pressure(double r) const { return (ambient + 2 * surface_tension / radius) * std::exp(-3 * polytropic * std::log(r / radius)); }
  /// R'' [m/s^2] in a liquid of pressure p.
  [[nodiscard]] double acceleration(State s, double p) const { return bubble_acceleration(*this, s.radius, s.rate, p, gas_pressure(s.radius)); }
  /// Square of the natural frequency of small oscillations without losses [1/s^2].
  [[nodiscard]] double natural_squared() const {
    const double tension = 2 * surface_tension / radius;
    return (3 * polytropic * (ambient + tension) - tension) / (density * radius * radius);
  }
  /// Square of the fastest rate at which the bubble changes now [1/s^2].
  [[nodiscard]] double rate_squared(State s, double p) const { return bubble_rate_squared(*this, s.radius, s.rate, p, gas_pressure(s.radius)); }
};

/// The bubble after the time `span` [s] in a liquid of `pressure(t, R)` [Pa above ambient], 0 <= t <= span. `stiffness(R)` is the
/// square of the frequency that the liquid's answer to the bubble adds [1/s^2], 0 where the pressure is imposed.
///
/// Classical Runge-Kutta steps of at most 0.4 / sqrt(rate^2 + stiffness): explicit, since the equation's velocity terms would
/// make a leapfrog implicit; stable for oscillations up to 2.8 and for decay up to 2.7 in these units; of fourth order, so that an
/// oscillation loses 4e-4 of its amplitude a period at that bound. `greatest_step` [s] bounds it further.
/// Errors: NumericsError when the bubble vanishes or needs more than `most_steps`.
template <class Pressure, class Stiffness>
[[nodiscard]] KellerMiksis::State advance_bubble(const KellerMiksis& b, KellerMiksis::State s, double span, double greatest_step, Pressure&& pressure,
                                                 Stiffness&& stiffness, int most_steps = 200000) {
  using State = KellerMiksis::State;
  for (double t = 0; t < span;) {
    if (most_steps-- == 0) throw NumericsError("a bubble's collapse is too violent to follow");
    const double p = pressure(t, s.radius), limit = std::min(greatest_step, 0.4 / std::sqrt(b.rate_squared(s, p) + stiffness(s.radius)));
    const double left = span - t, h = left / std::ceil(left / limit);
    const State k1{s.rate, b.acceleration(s, p)};
    const auto stage = [&](double share, const State& k) {
      const State at{s.radius + share * h * k.radius, s.rate + share * h * k.rate};
      return State{at.rate, b.acceleration(at, pressure(t + share * h, at.radius))};
    };
    const State k2 = stage(0.5, k1), k3 = stage(0.5, k2), k4 = stage(1, k3);
    s.radius += h / 6 * (k1.radius + 2 * k2.radius + 2 * k3.radius + k4.radius);
    s.rate += h / 6 * (k1.rate + 2 * k2.rate + 2 * k3.rate + k4.rate);
    if (!(s.radius > 0) || !std::isfinite(s.rate)) throw NumericsError("a bubble collapses to nothing");
    t = h < left ? t + h : span;
  }
  return s;
}

}  // namespace calomel
