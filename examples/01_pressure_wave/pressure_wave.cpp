// A pressure wave in mercury hits a steel wall. Everything about it is known exactly, so it shows how to use the
// explicit solver from a program, and how far its numbers can be trusted on a mesh of a given size.
//
// The exact answer: the wave's pressure p(t - x/c) meets steel of impedance Z_s from mercury of impedance Z_m (Z = density x
// wave speed). R = (Z_s - Z_m)/(Z_s + Z_m) comes back and T = 1 + R goes on (e.g. Kinsler et al. 2000, section 6.2).
// In a wall of thickness h the wave then runs to and fro: -1 of it turns round at the free outer face and -R at the mercury.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "examples/expected.hpp"
#include "forward/solver/explicit_solver.hpp"

using namespace calomel;

namespace {

constexpr double mercury_density = 13500, mercury_speed = 1450;                              // nominal values of the published target
constexpr double steel_density = 7960, steel_young = 193e9, steel_poisson = 0.29;            // 316L
constexpr double mercury_length = 0.15;                                                      // the wall's inner face [m]
constexpr double peak = 20e6, start = 0.05, width = 0.006;                                   // Gaussian wave: height [Pa], place and sd [m]
constexpr double mercury_gauge = 0.10, first_steel_gauge = 0.17, second_steel_gauge = 0.25;  // [m]

const LinearElastic steel = LinearElastic::from_young(steel_young, steel_poisson);
const double bulk_modulus = mercury_density * mercury_speed * mercury_speed;
const double steel_speed = std::sqrt(steel.longitudinal_modulus() / steel_density);
const double Z_m = mercury_density * mercury_speed, Z_s = steel_density * steel_speed;
const double R = (Z_s - Z_m) / (Z_s + Z_m);

// Node `corner` of layer i. Layers 0 .. n_m are mercury, the others steel; both materials have nodes of their own at the
// wall's inner face, because they slip there.
NodeId node_of(int layer, int corner) { return NodeId(4 * layer + corner); }

struct Column {
  Mesh mesh;
  int n_m = 0, n_s = 0;  // elements
  double h = 0;
};

// 1. Make the mesh: a column of cubes, mercury and then steel, that moves along x only.
Column make_column(double h, double wall) {
  Column c;
  c.h = h;
  c.n_m = int(std::lround(mercury_length / h));
  c.n_s = int(std::lround(wall / h));
  const auto add_layer = [&](double x) {
    for (int corner = 0; corner < 4; ++corner) c.mesh.nodes.push_back({x, corner & 1 ? h : 0, corner & 2 ? h : 0});
  };
  const auto add_element = [&](int layer, Region region) {
    std::array<NodeId, 8> e;  // corner i + 2j + 4k: bit 0 is x, bit 1 is y, bit 2 is z
    for (int a = 0; a < 8; ++a) e[std::size_t(a)] = node_of(layer + (a & 1), a >> 1);
    c.mesh.elements.push_back(e);
    c.mesh.region.push_back(region);
  };
  for (int i = 0; i <= c.n_m; ++i) add_layer(i * h);
  for (int i = 0; i <= c.n_s; ++i) add_layer(mercury_length + i * h);
  for (int i = 0; i < c.n_m; ++i) add_element(i, Region::mercury);
  for (int i = 0; i < c.n_s; ++i) add_element(c.n_m + 1 + i, Region::steel);
  constexpr std::uint8_t y_and_z = 0b110;
  c.mesh.fixed.assign(c.mesh.nodes.size(), y_and_z);
  for (int corner = 0; corner < 4; ++corner)
    c.mesh.slip.push_back({.steel = node_of(c.n_m + 1, corner), .mercury = node_of(c.n_m, corner), .count = 1, .normals = {Vec3{1, 0, 0}}});
  c.mesh.liquid_element_size = h;
  return c;
}

// 2. State the physics: linear mercury and steel, and the wave as an initial state. A wave to the right of pressure p(x)
// has the displacement 1/K int_x^inf p dx' and the velocity p / (rho c).
RunSetup make_setup(const Column& c, double end) {
  RunSetup s;
  s.steel_density = steel_density;
  s.liquid_density = mercury_density;
  s.steel = steel;
  s.liquid = {.bulk_modulus = bulk_modulus, .tensile_cutoff = std::numeric_limits<double>::infinity(), .viscosity = 0};
  s.initial_displacement.resize(c.mesh.nodes.size());
  s.initial_velocity.resize(c.mesh.nodes.size());
  for (std::size_t n = 0; n < c.mesh.nodes.size(); ++n) {
    const double from_start = c.mesh.nodes[n][0] - start;
    const double area = peak * width * std::sqrt(M_PI / 2) * std::erfc(from_start / (std::sqrt(2.0) * width));
    s.initial_displacement[n][0] = area / bulk_modulus;
    s.initial_velocity[n][0] = peak * std::exp(-0.5 * from_start * from_start / (width * width)) / Z_m;
  }
  s.end = end;
  s.output_interval = 1e-7;
  return s;
}

// 3. Say what is observed: the pressure of one element is its bulk (in 1-D, longitudinal) modulus times its shortening.
ObservationRow pressure_of(const Column& c, double x) {
  const bool in_steel = x > mercury_length;
  const int layer = in_steel ? c.n_m + 1 + int((x - mercury_length) / c.h) : int(x / c.h);
  const double modulus = in_steel ? steel.longitudinal_modulus() : bulk_modulus;
  return {{node_of(layer, 0), node_of(layer + 1, 0)}, {Vec3{modulus / c.h, 0, 0}, Vec3{-modulus / c.h, 0, 0}}};
}
double centre_of(const Column& c, double x) {  // of the element that pressure_of observes
  const double from = x > mercury_length ? mercury_length : 0;
  return from + (std::floor((x - from) / c.h) + 0.5) * c.h;
}
ObservationRow outer_face(const Column& c) { return {{node_of(c.n_m + 1 + c.n_s, 0)}, {Vec3{1, 0, 0}}}; }

// The exact solution.
double incident(double t) {  // at the wall's inner face [Pa]
  const double x = mercury_speed * t - (mercury_length - start);
  return peak * std::exp(-0.5 * x * x / (width * width));
}
double incident_impulse(double t) {  // its integral up to t [Pa s]
  const double x = mercury_speed * t - (mercury_length - start);
  return peak * width / mercury_speed * std::sqrt(M_PI / 2) * (1 + std::erf(x / (std::sqrt(2.0) * width)));
}
/// sum over k of R^k f(t - k tau): the rounds in the wall.
double rounds(const std::function<double(double)>& f, double t, double tau) {
  double sum = 0, factor = 1;
  while (factor > 1e-12) sum += factor * f(t), factor *= R, t -= tau;
  return sum;
}
/// Pressure at x in the mercury before a wall of thickness h: what comes, what the inner face and what the rounds return [Pa].
double exact_mercury_pressure(double x, double t, double h) {
  const double tau = 2 * h / steel_speed, back = t - (mercury_length - x) / mercury_speed;
  return incident(t + (mercury_length - x) / mercury_speed) + R * incident(back) - (1 - R * R) * rounds(incident, back - tau, tau);
}
double exact_outer_displacement(double t, double h) { return 2 * (1 + R) / Z_s * rounds(incident_impulse, t - h / steel_speed, 2 * h / steel_speed); }

/// Height and time of the highest sample in [from, to), a parabola through it and its neighbours.
struct Peak {
  double time, value;
};
Peak highest(std::span<const double> times, std::span<const double> y, double from, double to) {
  std::size_t best = 0;
  for (std::size_t i = 1; i + 1 < y.size(); ++i)
    if (times[i] >= from && times[i] < to && (best == 0 || y[i] > y[best])) best = i;
  const double a = y[best - 1], b = y[best], c = y[best + 1], shift = 0.5 * (a - c) / (a - 2 * b + c);
  return {times[best] + shift * (times[1] - times[0]), b - 0.25 * (a - c) * shift};
}

/// Relative L2 distance of two histories [-].
double distance(std::span<const double> y, const std::function<double(std::size_t)>& exact) {
  double squares = 0, norm = 0;
  for (std::size_t i = 0; i < y.size(); ++i) squares += std::pow(y[i] - exact(i), 2), norm += std::pow(exact(i), 2);
  return std::sqrt(squares / norm);
}

std::span<const double> row(const SolveSummary& s, std::size_t i) { return std::span(s.observations).subspan(i * s.times.size(), s.times.size()); }

}  // namespace

int main(int argc, char** argv) try {
  std::map<std::string, double> found;
  const auto print = [&](const std::string& what, double h, double exact, double simulated, const char* unit) {
    fmt::print("{:<44} {:>5.2f} mm {:>12.6g} {:>12.6g} {:<5} {:>+9.4f} %\n", what, 1e3 * h, exact, simulated, unit, 100 * (simulated / exact - 1));
  };
  fmt::print("Z of mercury {:.2f} MRayl, of steel {:.2f} MRayl\n\n{:<44} {:>8} {:>12} {:>12} {:<5} {:>11}\n", Z_m / 1e6, Z_s / 1e6, "", "elements", "exact",
             "simulated", "", "error");
  for (const double h : {1e-3, 0.5e-3, 0.25e-3}) {
    const std::string size = fmt::format(" at {} mm", 1e3 * h);

    // 4. A wall so thick that nothing returns from its outer face: coefficients and speeds.
    {
      const Column column = make_column(h, 0.3);
      const ObservationRow rows[] = {pressure_of(column, mercury_gauge), pressure_of(column, first_steel_gauge), pressure_of(column, second_steel_gauge)};
      const auto result = ExplicitSolver(column.mesh, steel).solve(make_setup(column, 1.15e-4), rows, {.energy_balance = true});
      const double t_wall = (mercury_length - start) / mercury_speed;
      const Peak coming = highest(result.times, row(result, 0), 0, t_wall), returned = highest(result.times, row(result, 0), t_wall, 1);
      const Peak near = highest(result.times, row(result, 1), 0, 1), far = highest(result.times, row(result, 2), 0, 1);
      const double x = centre_of(column, mercury_gauge), x1 = centre_of(column, first_steel_gauge), x2 = centre_of(column, second_steel_gauge);
      print("pressure that comes back, R", h, R, returned.value / coming.value, "");
      print("pressure that goes on, T", h, 1 + R, near.value / coming.value, "");
      print("wave speed in the mercury", h, mercury_speed, 2 * (mercury_length - x) / (returned.time - coming.time), "m/s");
      print("wave speed in the steel", h, steel_speed, (x2 - x1) / (far.time - near.time), "m/s");
      fmt::print("{:<44} {:>5.2f} mm {:>12} {:>12.2g}\n", "energy balance error", 1e3 * h, "0", result.energy_balance_error);
      found["R" + size] = returned.value / coming.value;
      found["T" + size] = near.value / coming.value;
      found["mercury speed" + size] = 2 * (mercury_length - x) / (returned.time - coming.time);
      found["steel speed" + size] = (x2 - x1) / (far.time - near.time);
      found["energy balance error" + size] = result.energy_balance_error;
    }

    // 5. A wall of 3 mm, as a target has: it gives way, and sends tension back into the mercury.
    {
      const double wall = 0.003;
      const Column column = make_column(h, wall);
      const ObservationRow rows[] = {pressure_of(column, mercury_gauge), outer_face(column)};
      const auto result = ExplicitSolver(column.mesh, steel).solve(make_setup(column, 1.3e-4), rows, {});
      const double x = centre_of(column, mercury_gauge);
      const double lowest = -highest(result.times, std::vector<double>([&] {
                                       std::vector<double> y;
                                       for (const double p : row(result, 0)) y.push_back(-p);
                                       return y;
                                     }()),
                                     0, 1)
                                 .value;
      double exact_lowest = 0;
      for (const double t : result.times) exact_lowest = std::min(exact_lowest, exact_mercury_pressure(x, t, wall));
      const double pressure = distance(row(result, 0), [&](std::size_t i) { return exact_mercury_pressure(x, result.times[i], wall); });
      const double motion = distance(row(result, 1), [&](std::size_t i) { return exact_outer_displacement(result.times[i], wall); });
      print("3 mm wall: lowest pressure before it", h, exact_lowest / 1e6, lowest / 1e6, "MPa");
      print("3 mm wall: displacement at the end", h, 1e6 * exact_outer_displacement(result.times.back(), wall), 1e6 * row(result, 1).back(), "um");
      fmt::print("{:<44} {:>5.2f} mm {:>12} {:>12.4f} %\n", "3 mm wall: pressure history, L2 error", 1e3 * h, "0", 100 * pressure);
      fmt::print("{:<44} {:>5.2f} mm {:>12} {:>12.4f} %\n\n", "3 mm wall: displacement history, L2 error", 1e3 * h, "0", 100 * motion);
      found["lowest pressure" + size] = lowest / 1e6;
      found["pressure error" + size] = pressure;
      found["displacement error" + size] = motion;
    }
  }
  found["order of the pressure error"] = std::log2(found["pressure error at 0.5 mm"] / found["pressure error at 0.25 mm"]);
  fmt::print("order of convergence of the pressure history: {:.2f}\n\n", found["order of the pressure error"]);

  // 6. With a file of expected numbers: hold this run against it.
  if (argc > 1 && !examples::as_expected(found, argv[1])) return 1;
  return 0;
} catch (const std::exception& e) {
  fmt::print(stderr, "{}\n", e.what());
  return 2;
}
