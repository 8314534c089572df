// Bulk cavitation under a plate (Bleich and Sandler 1970; numbers of physics.md section 4).
//
// Gravity and hydrostatic prestress need no terms of their own. In the frame that falls with g there is no weight; the pressure from below pushes plate
// and liquid up at g, and the pressure in them is the hydrostatic one. So the heating pressure is p0(z) = m g + rho g z
// (gauge), the same on the lower end of the column, and the cutoff is p_atm (absolute pressure 0); g t is subtracted from the velocities. The liquid is
// 18 m deep in place of 3.81 m with a non-reflecting lower face: no wave returns from below within 12 ms.
#include <fmt/format.h>

#include "tests/verification/column.hpp"
#include "tests/verification/rows.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

constexpr double gravity = 9.81, atmosphere = 0.101e6, end = 12.2e-3, interval = 2e-6;

struct Bulk {
  std::vector<double> time, velocity;      ///< of the plate [s], [m/s]
  std::vector<double> rise;                ///< [m], at time + interval / 2
  double first_time = 0, first_depth = 0;  ///< of cavitation
  double least_depth = 1e9, greatest_depth = 0;
  double closure_time = 0, closure_depth = 0;  ///< last of the zone to close before 11 ms
};

/// `damping`: viscosity over rho c h; `hydrostatic`: false leaves gravity out of the prestress.
Bulk run(double element_size, double damping, bool hydrostatic = true, double cutoff = atmosphere) {
  const double length = 18;
  const PlateOnColumn p{
      .density = 989, .speed = 1451, .mass = 144.7, .p0 = 0.7106e6, .theta = 0.9958e-3, .length = length, .n = int(std::lround(length / element_size))};
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
  s.liquid.tensile_cutoff = cutoff;
  s.liquid.viscosity = damping * p.density * p.speed * p.h();
  s.end_stress = {{0, 1}, {-pressure_at(length), -pressure_at(length)}};
  // The motion of the plate, and the stretch of each element down to 4.5 m.
  std::vector<ObservationRow> rows{component(nearest(mesh, {0, 0, 0}), 0)};
  std::vector<std::size_t> watched;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    if (depth[e] < 0 || depth[e] > 4.5) continue;
    watched.push_back(e);
    rows.push_back({{mesh.elements[e][1], mesh.elements[e][0]}, {{1 / p.h(), 0, 0}, {-1 / p.h(), 0, 0}}});
  }
  SolveOptions o;
  o.time_step_safety = 0.7;
  const auto out = ExplicitSolver(mesh, steel()).solve(s, rows, o);
  Bulk b;
  std::vector<bool> open(mesh.elements.size(), false);
  for (std::size_t i = 0; i < out.times.size(); ++i)
    for (std::size_t k = 0; k < watched.size(); ++k) {
      // An element has cavitated where its strain exceeds that of the cutoff (the pressure itself fluctuates with the viscosity).
      const std::size_t e = watched[k];
      const bool now = s.p0[e] - p.modulus() * row_of(out, k + 1)[i] < -cutoff * (1 + 1e-6);
      const double t = out.times[i];
      if (now && b.first_time == 0) b.first_time = t, b.first_depth = depth[e];
      if (now && t < 11e-3) b.least_depth = std::min(b.least_depth, depth[e]), b.greatest_depth = std::max(b.greatest_depth, depth[e]);
      if (open[e] && !now && t < 11e-3) b.closure_time = t, b.closure_depth = depth[e];
      open[e] = now;
    }
  // Velocities are means over 10 us, about the travel time through an element, so that ringing of the element is not taken for motion of the plate.
  const auto u = row_of(out, 0);
  for (std::size_t i = 0; i + 5 < u.size(); ++i) b.time.push_back(out.times[i] + 2.5 * interval), b.velocity.push_back((u[i + 5] - u[i]) / (5 * interval));
  double rise = 0;
  for (std::size_t i = 0; i < b.time.size(); ++i) b.velocity[i] -= g * b.time[i], rise += b.velocity[i] * interval, b.rise.push_back(rise);
  return b;
}

double at(const Bulk& b, double t) {
  const std::size_t i = std::size_t((t - b.time[0]) / interval);
  const double share = (t - b.time[i]) / interval;
  return (1 - share) * b.velocity[i] + share * b.velocity[i + 1];
}

/// Time at which the velocity first falls to zero [s].
double zero_crossing(const Bulk& b) {
  for (std::size_t i = 100; i + 1 < b.time.size(); ++i)
    if (b.velocity[i] > 0 && b.velocity[i + 1] <= 0) return b.time[i] + interval * b.velocity[i] / (b.velocity[i] - b.velocity[i + 1]);
  return 0;
}

/// Time at which the liquid hits the plate again, by the steepest rise of the velocity after 11 ms [s].
double reload(const Bulk& b) {
  std::size_t best = std::size_t(11e-3 / interval);
  for (std::size_t i = best; i + 2 < b.time.size(); ++i)
    if (b.velocity[i + 1] - b.velocity[i] > b.velocity[best + 1] - b.velocity[best]) best = i;
  return (b.time[best] + b.time[best + 1]) / 2;
}

/// The same check for each number: its value in a run, its reference, the allowed difference, and the run that must fail.
struct Reading {
  std::string name, unit;
  double reference, tolerance;
  std::function<double(const Bulk&)> value;
  std::string control;
  const Bulk* spoiled;
};

}  // namespace

// No tolerances are stated. Elements of 6.25 mm (4.3 us of travel) with a viscosity of 0.1 rho c h make a method of first order, h / (c theta) = 0.4 %:
// velocities are held to 1 % of the peak, times to 1 % or two elements' travel, depths to 5 % or two elements; the place of closure, given as "near", to 10 %.
TEST(BleichSandler, BulkCavitationOpensAndClosesAsInTheConvergedSolution) {
  const double h = 0.00625, travel = 2 * h / 1451;
  const Bulk b = run(h, 0.1), coarse = run(2 * h, 0.1), linear = run(2 * h, 0.1, true, 1e15), weightless = run(2 * h, 0.1, false),
             strong = run(2 * h, 0.1, true, 2 * atmosphere);
  const auto peak = [](const Bulk& r) { return std::max_element(r.velocity.begin(), r.velocity.begin() + std::ptrdiff_t(1e-3 / interval)); };
  const auto rise = [](const Bulk& r) { return 1e3 * *std::max_element(r.rise.begin(), r.rise.end()); };
  std::vector<Reading> readings{
      {"peak velocity", "m/s", 0.7649, 0.0076, [&](const Bulk& r) { return *peak(r); }, "", nullptr},
      {"time of the peak", "ms", 0.257, 1e3 * travel, [&](const Bulk& r) { return 1e3 * r.time[std::size_t(peak(r) - r.velocity.begin())]; }, "", nullptr},
      {"first cavitation, time", "ms", 0.361, 1e3 * travel, [](const Bulk& r) { return 1e3 * r.first_time; }, "cutoff twice as strong", &strong},
      {"first cavitation, depth", "m", 0.13, 2 * h, [](const Bulk& r) { return r.first_depth; }, "cutoff twice as strong", &strong},
      {"zone, upper end", "m", 0.075, 2 * h, [](const Bulk& r) { return r.least_depth; }, "", nullptr},
      {"zone, lower end", "m", 3.26, 0.05 * 3.26, [](const Bulk& r) { return r.greatest_depth; }, "no gravity", &weightless},
      {"velocity zero", "ms", 5.96, 0.0596, [](const Bulk& r) { return 1e3 * zero_crossing(r); }, "no gravity", &weightless},
      {"largest rise", "mm", 1.707, 0.01707, rise, "no gravity", &weightless},
      {"closure, time", "ms", 10.24, 0.1024, [](const Bulk& r) { return 1e3 * r.closure_time; }, "no gravity", &weightless},
      {"closure, depth", "m", 2.1, 0.21, [](const Bulk& r) { return r.closure_depth; }, "cutoff twice as strong", &strong},
      {"re-load", "ms", 11.72, 0.1172, [](const Bulk& r) { return 1e3 * reload(r); }, "no cutoff", &linear}};
  const std::vector<double> times{1, 2, 4, 8, 10}, references{.542, .369, .146, -.105, -.169};
  for (std::size_t i = 0; i < times.size(); ++i)
    readings.push_back({fmt::format("velocity at {:.0f} ms", times[i]), "m/s", references[i], 0.0076,
                        [&times, i](const Bulk& r) { return at(r, 1e-3 * times[i]); }, "no cutoff", &linear});
  const double order = drawn_order("Bleich-Sandler, rise", {1, 0.5}, {rise(coarse) / 1.707 - 1, rise(b) / 1.707 - 1});
  for (const auto& r : readings)
    verify({.item = "Bleich-Sandler",
            .quantity = r.name,
            .unit = r.unit,
            .reference = r.reference,
            .source = "converged solution of Bleich and Sandler's problem",
            .measured = r.value(b),
            .tolerance = r.tolerance,
            .order = r.name == "largest rise" ? order : std::nan(""),
            .control = r.spoiled ? r.control : "the rows with other controls",
            .control_value = r.spoiled ? r.value(*r.spoiled) : std::nan("")});
  std::vector<double> t, v;
  for (std::size_t i = 0; i < b.time.size(); i += 20) t.push_back(1e3 * b.time[i]), v.push_back(b.velocity[i]);
  draw("bleich_sandler", "solver, 6.25 mm", t, v);
  std::vector<double> x{0.257, 5.96}, y{0.7649, 0};
  x.insert(x.end(), times.begin(), times.end());
  y.insert(y.end(), references.begin(), references.end());
  draw("bleich_sandler", "reference (points)", x, y);
}
