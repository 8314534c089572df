#pragma once
/// Single bubbles, and one point of a liquid with bubbles.
#include <complex>

#include "base/linear_algebra.hpp"
#include "forward/mechanism/bubbly_liquid.hpp"
#include "tests/verification/one_point.hpp"
#include "tests/verification/small_runs.hpp"

namespace calomel::testing {

inline constexpr double unbounded = std::numeric_limits<double>::infinity();

/// The bubble in a liquid whose pressure remains at p.
inline KellerMiksis::State under(const KellerMiksis& b, KellerMiksis::State s, double p, double span, double greatest_step = unbounded) {
  return advance_bubble(
      b, s, span, greatest_step, [p](double, double) { return p; }, [](double) { return 0.0; });
}

struct Collapse {
  double time, least, rebound;  ///< [s]; over R0
};

/// First minimum of the radius after the pressure has risen to p, and the following maximum.
inline Collapse collapse(const KellerMiksis& b, double p, double interval, double greatest_step = unbounded) {
  KellerMiksis::State s{b.radius, 0};
  Collapse c{0, 1, 0};
  for (double t = 0, before = 0; t < 1; t += interval, before = s.rate) {
    const double radius = s.radius / b.radius;
    if (radius < c.least) c.least = radius, c.time = t;
    s = under(b, s, p, interval, greatest_step);
    if (before > 0 && s.rate <= 0) {
      c.rebound = std::max(radius, s.radius / b.radius);
      return c;
    }
  }
  return c;
}

// Mercury at 333 K, without regularising viscosity, which never reaches its cutoff.
inline const Riemer mercury{mercury_density * mercury_speed * mercury_speed, unbounded, 0};

/// Helium at 0.3 MPa in mercury, R0 100 um (physics.md section 4).
inline KellerMiksis helium(double kappa, double surface_tension = 0.47, double viscosity = 1.3e-3) {
  return {.density = mercury_density,
          .sound_speed = mercury_speed,
          .radius = 1e-4,
          .ambient = 3e5,
          .polytropic = kappa,
          .surface_tension = surface_tension,
          .viscosity = viscosity};
}

/// One point of liquid with bubbles.
class OnePoint : public DrivenPoint {
 public:
  OnePoint(const BubblyLiquid& law, double dt) : DrivenPoint(law, dt) {}
  [[nodiscard]] double radius() const { return state(0); }
};

/// Rises smoothly from 0 to 1 over the time `rise`.
inline double soft(double t, double rise) { return t >= rise ? 1 : 0.5 - 0.5 * std::cos(M_PI * t / rise); }

/// Speed at which sound of frequency f [Hz] runs through the law: p = -K e at e = small sin(w t), K complex, k^2 = rho w^2 / K.
inline double phase_speed(const BubblyLiquid& law, double f, double small) {
  const double w = 2 * M_PI * f, dt = 2.5e-7, rise = 12 / f + 2e-3, end = rise + 10 / f;
  OnePoint point(law, dt);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(3, 3);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(3);
  for (double t = 0; t < end; t += dt) {
    const double p = point.step(small * soft(t, rise) * std::sin(w * t));
    if (t < rise) continue;
    const Eigen::Vector3d a(std::sin(w * t), std::cos(w * t), 1);
    normal += a * a.transpose();
    right += p * a;
  }
  const Eigen::Vector3d fit = solve_symmetric(normal, right);
  const std::complex<double> modulus(-fit[0] / small, -fit[1] / small);
  return w / (w * std::sqrt(mercury_density / modulus)).real();
}

/// Commander and Prosperetti: k^2 = w^2/c^2 + 4 pi w^2 n R0 / (w0^2 - w^2 + 2 i b w), losses by viscosity and radiation.
inline double commander_prosperetti(const KellerMiksis& b, double alpha0, double f) {
  const double w = 2 * M_PI * f, damping = 2 * b.viscosity / (b.density * b.radius * b.radius) + w * w * b.radius / (2 * b.sound_speed);
  const std::complex<double> resonance(b.natural_squared() - w * w, 2 * damping * w);
  return w / std::sqrt(w * w / (b.sound_speed * b.sound_speed) + 3 * alpha0 * w * w / (b.radius * b.radius) / resonance).real();
}

}  // namespace calomel::testing
