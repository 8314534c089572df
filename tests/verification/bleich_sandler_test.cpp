// Bulk cavitation under a plate (Bleich and Sandler 1970; numbers of physics.md section 4).
//
// Gravity and hydrostatic prestress need no terms of their own. In the frame that falls with g there is no weight; plate and liquid are pushed up
// by the pressure from below and rise together at g, and the pressure in them is the hydrostatic one. So: heating pressure p0(z) = m g + rho g z
// (gauge), the same on the lower end of the column, cutoff p_atm (absolute pressure 0); g t comes off the velocities afterwards. The liquid is
// 18 m deep in place of 3.81 m with a non-reflecting lower face: nothing comes back from below within 12 ms.
#include "tests/verification/column.hpp"
#include "tests/verification/rows.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

constexpr double gravity = 9.81, atmosphere = 0.101e6, end = 12.2e-3, interval = 1e-5;

struct Bulk {
  std::vector<double> time, velocity;         ///< of the plate [s], [m/s]
  std::vector<double> rise;                   ///< [m], at time + interval / 2
  double first_time = 0, first_depth = 0;     ///< of cavitation
  double least_depth = 1e9, greatest_depth = 0;
  double closure_time = 0, closure_depth = 0; ///< last of the zone to close before 11 ms
};

/// `damping`: viscosity over rho c h; `hydrostatic`: false leaves gravity out of the prestress.
Bulk run(double element_size, double damping, bool hydrostatic) {
  const double length = 18;
  const PlateOnColumn p{.density = 989, .speed = 1451, .mass = 144.7, .p0 = 0.7106e6, .theta = 0.9958e-3, .length = length, .n = int(std::lround(length / element_size))};
  Mesh mesh = p.mesh();
  // The lower end, whose outward normal is -x.
  mesh.loaded.push_back({.nodes = {}, .element = 0});
  for (std::size_t k = 0; k < 4; ++k) mesh.loaded[0].nodes[k] = mesh.elements[0][std::size_t(hexahedron::faces[0][k])];
  RunSetup s = p.setup(mesh, end, interval);
  const double g = hydrostatic ? gravity : 0;
  const auto pressure_at = [&](double depth) { return p.mass * g + p.density * g * depth; };
  s.p0.assign(mesh.elements.size(), 0);
  std::vector<double> depth(mesh.elements.size(), -1);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    if (mesh.region[e] == Region::mercury) {
      depth[e] = -(mesh.nodes[std::size_t(mesh.elements[e][0])][0] + mesh.nodes[std::size_t(mesh.elements[e][7])][0]) / 2;
      s.p0[e] = pressure_at(depth[e]);
    }
  s.liquid.tensile_cutoff = atmosphere;
  s.liquid.viscosity = damping * p.density * p.speed * p.h();
  s.end_stress = {{0, 1}, {-pressure_at(length), -pressure_at(length)}};
  Bulk b;
  std::vector<bool> open(mesh.elements.size(), false);
  SolveOptions o;
  o.time_step_safety = 0.7, o.field_interval = interval;
  o.on_field = [&](const FieldSnapshot& f) {
    for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
      if (depth[e] < 0) continue;
      // Cavitated: the liquid is wider than the cutoff's strain (its pressure would flicker with the viscosity).
      const auto& nodes = mesh.elements[e];
      const double strain = (f.displacement[std::size_t(nodes[1])][0] - f.displacement[std::size_t(nodes[0])][0]) / p.h();
      const bool now = s.p0[e] - p.modulus() * strain < -atmosphere * (1 + 1e-6);
      if (now && b.first_time == 0) b.first_time = f.time, b.first_depth = depth[e];
      if (now && f.time < 11e-3) b.least_depth = std::min(b.least_depth, depth[e]), b.greatest_depth = std::max(b.greatest_depth, depth[e]);
      if (open[e] && !now && f.time < 11e-3) b.closure_time = f.time, b.closure_depth = depth[e];
      open[e] = now;
    }
  };
  const std::vector<ObservationRow> rows{component(nearest(mesh, {0, 0, 0}), 0)};
  const auto out = ExplicitSolver(mesh, steel()).solve(s, rows, o);
  b.time = middles(out.times), b.velocity = velocities(out.times, row_of(out, 0));
  double rise = 0;
  for (std::size_t i = 0; i < b.time.size(); ++i) b.velocity[i] -= g * b.time[i], rise += b.velocity[i] * interval, b.rise.push_back(rise);
  return b;
}

double at(const Bulk& b, double t) {
  const std::size_t i = std::size_t((t - b.time[0]) / interval);
  const double share = (t - b.time[i]) / interval;
  return (1 - share) * b.velocity[i] + share * b.velocity[i + 1];
}

/// When the velocity first falls to zero [s].
double zero_crossing(const Bulk& b) {
  for (std::size_t i = 10; i + 1 < b.time.size(); ++i)
    if (b.velocity[i] > 0 && b.velocity[i + 1] <= 0) return b.time[i] + interval * b.velocity[i] / (b.velocity[i] - b.velocity[i + 1]);
  return 0;
}

/// When the plate is hit from below again: the steepest rise of the velocity after 11 ms [s].
double reload(const Bulk& b) {
  std::size_t best = 1100;
  for (std::size_t i = 1100; i + 2 < b.time.size(); ++i)
    if (b.velocity[i + 1] - b.velocity[i] > b.velocity[best + 1] - b.velocity[best]) best = i;
  return (b.time[best] + b.time[best + 1]) / 2;
}

}  // namespace

TEST(BleichSandler, PROTOTYPE) {
  for (const double h : {0.05, 0.025, 0.0125})
    for (const double d : {0.1, 0.3}) {
      const Bulk b = run(h, d, true);
      const auto peak = std::max_element(b.velocity.begin(), b.velocity.end());
      fmt::print("h {} d {}: peak {:.4f} at {:.3f} ms, first {:.3f} ms at {:.3f}, zone {:.3f} {:.3f}, zero {:.3f}, rise {:.4f} mm, closure {:.2f} at {:.2f}, reload {:.2f}; v", h, d, *peak,
                 1e3 * b.time[std::size_t(peak - b.velocity.begin())], 1e3 * b.first_time, b.first_depth, b.least_depth, b.greatest_depth, 1e3 * zero_crossing(b),
                 1e3 * *std::max_element(b.rise.begin(), b.rise.end()), 1e3 * b.closure_time, b.closure_depth, 1e3 * reload(b));
      for (const double t : {1., 2., 4., 8., 10.}) fmt::print(" {:.4f}", at(b, 1e-3 * t));
      fmt::print("\n");
    }
}
