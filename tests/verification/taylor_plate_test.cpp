// An exponential wave hits a free plate through a liquid that holds tension (Taylor 1941):
// v = 2 p0 theta / (m (B - 1)) (exp(-t / theta) - exp(-B t / theta)), B = rho c theta / m.
#include "tests/verification/column.hpp"
#include "tests/verification/rows.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

/// 144.7 kg/m^2 on water, as in Bleich and Sandler's problem without its cutoff: B = 9.88.
PlateOnColumn plate(int n) { return {.density = 989, .speed = 1451, .mass = 144.7, .p0 = 0.7106e6, .theta = 0.9958e-3, .length = 8, .n = n}; }

struct Flight {
  double error = 0;  ///< L2 of the velocity over 5 ms, relative
  double peak = 0;   ///< [m/s]
};

double exact_displacement(const PlateOnColumn& p, double t) {
  const double B = p.density * p.speed * p.theta / p.mass, scale = 2 * p.p0 * p.theta / (p.mass * (B - 1));
  return scale * p.theta * ((1 - std::exp(-t / p.theta)) - (1 - std::exp(-B * t / p.theta)) / B);
}

Flight fly(int n, double mass_factor) {
  const PlateOnColumn p = plate(n);
  PlateOnColumn spoiled = p;
  spoiled.mass *= mass_factor;
  const Mesh mesh = spoiled.mesh();
  const RunSetup s = spoiled.setup(mesh, 5e-3, 2e-5);
  const std::vector<ObservationRow> rows{component(nearest(mesh, {0, 0, 0}), 0)};
  const auto out = ExplicitSolver(mesh, steel()).solve(s, rows, {});
  std::vector<double> exact;
  for (const double t : out.times) exact.push_back(exact_displacement(p, t));
  const auto v = velocities(out.times, row_of(out, 0)), w = velocities(out.times, exact);
  double square = 0, size = 0;
  for (std::size_t i = 0; i < v.size(); ++i) square += std::pow(v[i] - w[i], 2), size += w[i] * w[i];
  return {std::sqrt(square / size), *std::max_element(v.begin(), v.end())};
}

}  // namespace

// With elements of 20 mm the wave reflected from the plate begins with a jump, so that the method is of first order. The error is rho h / 2 m = 7 % of added
// liquid times h / (c theta) = 1.4 %; 1 % is allowed.
TEST(TaylorPlate, MovesAccordingToTheFormula) {
  const Flight coarse = fly(200, 1), fine = fly(400, 1), spoiled = fly(400, 1.05);
  verify({.item = "Taylor plate",
          .quantity = "velocity over 5 ms, relative L2",
          .reference = 0,
          .source = "Taylor 1941, B = 9.88",
          .measured = fine.error,
          .tolerance = 0.01,
          .order = drawn_order("Taylor plate", {1, 0.5}, {coarse.error, fine.error}),
          .control = "plate 5 % heavier",
          .control_value = spoiled.error});
  const PlateOnColumn p = plate(1);
  const double B = p.density * p.speed * p.theta / p.mass, peak = 2 * p.p0 / (p.density * p.speed) * std::pow(B, 1 / (1 - B));
  verify({.item = "Taylor plate",
          .quantity = "peak velocity",
          .unit = "m/s",
          .reference = peak,
          .source = "2 p0/(rho c) B^(1/(1-B))",
          .measured = fine.peak,
          .tolerance = 0.01 * peak,
          .control = "see the row above"});
}
