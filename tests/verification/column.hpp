#pragma once
/// A plate on a column of liquid, motion along x only: the problems of Taylor (1941) and of Bleich and Sandler (1970).
#include "tests/verification/small_runs.hpp"

namespace calomel::testing {

/// Liquid on -length < x < 0 in n elements under one element of steel of this mass per area [kg/m^2]; x points out of the liquid.
struct PlateOnColumn {
  double density, speed, mass;  ///< of the liquid [kg/m^3], [m/s]; of the plate
  double p0, theta;             ///< incident pressure p0 exp(-t / theta) at the plate [Pa], [s]
  double length;                ///< of the liquid [m]
  int n;

  [[nodiscard]] double h() const { return length / n; }
  [[nodiscard]] double modulus() const { return density * speed * speed; }
  [[nodiscard]] Mesh mesh() const {
    const double plate = mass / steel_density, side = h();
    Mesh m = block({n + 1, 1, 1}, {-double(n), 0, 0}, {1, side, side}, [](const Vec3& x) { return x[0] < 0 ? Region::mercury : Region::steel; });
    for (auto& x : m.nodes) x[0] *= x[0] < 0 ? side : plate;
    m.liquid_element_size = side;
    fix(m, 2 | 4, everywhere());
    return m;
  }
  /// The wave when its front is at the plate: p = p0 exp(x / (c theta)), v = p / (rho c), u' = -p / K. The plate is at rest except for the motion of
  /// the half element of liquid that moves with it.
  [[nodiscard]] RunSetup setup(const Mesh& m, double end, double interval) const {
    RunSetup s = linear_setup(end, interval);
    s.liquid_density = density;
    s.liquid.bulk_modulus = modulus();
    const double decay = speed * theta, v0 = p0 / (density * speed), carried = density * h() / 2;
    s.initial_displacement = field(m, [&](const Vec3& x) { return Vec3{x[0] < 0 ? p0 * decay / modulus() * (1 - std::exp(x[0] / decay)) : 0, 0, 0}; });
    s.initial_velocity = field(m, [&](const Vec3& x) { return Vec3{x[0] < -1e-9 ? v0 * std::exp(x[0] / decay) : v0 * carried / (carried + mass), 0, 0}; });
    return s;
  }
};

/// Mean velocities [m/s] between the times of a record of displacement.
inline std::vector<double> velocities(std::span<const double> t, std::span<const double> u) {
  std::vector<double> v;
  for (std::size_t i = 0; i + 1 < t.size(); ++i) v.push_back((u[i + 1] - u[i]) / (t[i + 1] - t[i]));
  return v;
}

}  // namespace calomel::testing
