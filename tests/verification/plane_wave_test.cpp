// Plane waves: speed, order under refinement, and reflection where mercury meets steel.
#include <fmt/format.h>

#include "tests/verification/rows.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

/// A column of n elements along x whose nodes move along x only.
Mesh column(int n, double length, const std::function<Region(const Vec3&)>& region_at) {
  const double h = length / n;
  Mesh m = block({n, 1, 1}, {0, 0, 0}, {length, h, h}, region_at);
  fix(m, 2 | 4, everywhere());
  return m;
}

double gauss(double x, double sd) { return std::exp(-0.5 * x * x / (sd * sd)); }

/// A pulse u = 1e-6 gauss(x - at) that travels to the right with speed c.
void launch(RunSetup& s, const Mesh& mesh, double at, double sd, double c) {
  s.initial_displacement = field(mesh, [&](const Vec3& x) { return Vec3{1e-6 * gauss(x[0] - at, sd), 0, 0}; });
  s.initial_velocity = field(mesh, [&](const Vec3& x) { return Vec3{1e-6 * c * (x[0] - at) / (sd * sd) * gauss(x[0] - at, sd), 0, 0}; });
}

struct Transit {
  double speed, error;  ///< [m/s]; L2 of the displacement against the exact pulse, relative
};

/// 0.2 m of travel in a 0.4 m column; the speed from the centroids of u^2.
Transit transit(Region region, int n, double true_speed, const RunSetup& base) {
  const double length = 0.4, sd = 0.01, from = 0.1, time = 0.2 / true_speed;
  const Mesh mesh = column(n, length, [&](const Vec3&) { return region; });
  const ExplicitSolver solver(mesh, base.steel);
  RunSetup s = base;
  s.end = s.output_interval = time;
  launch(s, mesh, from, sd, true_speed);
  const auto u = final_displacement(mesh, solver.solve(s, all_components(mesh), {}));
  double weight = 0, moment = 0, square = 0, exact = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double x = mesh.nodes[i][0], e = 1e-6 * gauss(x - 0.3, sd);
    weight += u[i][0] * u[i][0];
    moment += x * u[i][0] * u[i][0];
    square += (u[i][0] - e) * (u[i][0] - e);
    exact += e * e;
  }
  return {(moment / weight - from) / time, std::sqrt(square / exact)};
}

}  // namespace

TEST(PlaneWave, SpeedAndOrderInBothMaterials) {
  for (const Region region : {Region::mercury, Region::steel}) {
    const std::string name = region == Region::mercury ? "mercury" : "steel";
    const double c = region == Region::mercury ? mercury_speed : steel_speed();
    const RunSetup setup = linear_setup(0, 0);
    const Transit coarse = transit(region, 100, c, setup), middle = transit(region, 200, c, setup), fine = transit(region, 400, c, setup);
    const std::vector<double> sizes{4, 2, 1}, errors{coarse.error, middle.error, fine.error};
    const double order = region == Region::mercury ? drawn_order("plane wave in mercury", sizes, errors) : observed_order(sizes, errors);
    EXPECT_NEAR(middle.speed, c, 0.005 * c);
    EXPECT_NEAR(fine.speed, c, 0.001 * c);
    EXPECT_GT(order, 1.8);
    EXPECT_GT(std::log2(coarse.error / middle.error), 1.8);
    // Control: a modulus that is 2 % too high gives a speed that is 1 % too high.
    RunSetup spoiled = setup;
    spoiled.liquid.bulk_modulus *= 1.02;
    spoiled.steel.lambda *= 1.02;
    spoiled.steel.mu *= 1.02;
    const Transit faster = transit(region, 400, c, spoiled);
    EXPECT_GT(faster.speed, 1.005 * c);
    verify({.item = "Plane wave",
            .quantity = "speed in " + name + ", 1 mm",
            .unit = "m/s",
            .reference = c,
            .source = "sqrt(modulus / density)",
            .measured = fine.speed,
            .tolerance = 0.001 * c,
            .control = "modulus +2 %",
            .control_value = faster.speed});
    // The front is 10 mm wide: lumped linear elements lag by (h / sd)^2 travel / 24 sd, 0.8 % at 1 mm, of which central differences cancel a part.
    verify({.item = "Plane wave",
            .quantity = "pulse in " + name + " after 20 widths, 1 mm, relative L2",
            .reference = 0,
            .source = "d'Alembert",
            .measured = fine.error,
            .tolerance = 0.008,
            .order = order,
            .control = "modulus +2 %",
            .control_value = faster.error});
  }
}

namespace {

struct Reflection {
  double reflected, transmitted;  ///< pressure over incident pressure
};

/// A pulse in mercury meets steel at x = 0.3; the reflected and the transmitted wave are projected on the exact shapes.
Reflection reflection(double h, double speed, double steel_stiffness, int common_normals, bool tied = false, int subcycles = 1) {
  const double wall = 0.3, length = 1.3, sd = 0.02;
  Mesh mesh = column(int(std::lround(length / h)), length, [&](const Vec3& x) { return x[0] < wall ? Region::mercury : Region::steel; });
  const std::size_t shared = mesh.nodes.size();
  if (!tied) split(mesh, std::vector<Vec3>(std::size_t(common_normals), Vec3{1, 0, 0}));
  const LinearElastic moduli{steel().lambda * steel_stiffness, steel().mu * steel_stiffness};
  const ExplicitSolver solver(mesh, moduli);
  const double travel = 0.32;  // of the pulse's centre in mercury: from 0.14 to the wall and 0.16 back
  RunSetup s = linear_setup(travel / speed, travel / speed);
  s.steel = moduli;
  s.liquid.bulk_modulus = mercury_density * speed * speed;
  launch(s, mesh, 0.14, sd, speed);
  SolveOptions options;
  options.subcycles = subcycles;
  const auto run = solver.solve(s, all_components(mesh), options);
  expect(run.subcycles == subcycles, "the run takes the sub-cycles that it is given");
  const auto u = final_displacement(mesh, run);
  const double c = steel_speed(), front = wall + 0.16 / speed * c;
  double ru = 0, rr = 0, tu = 0, tt = 0;
  for (std::size_t i = 0; i < shared; ++i) {
    const double x = mesh.nodes[i][0];
    if (x < wall) {
      const double f = 1e-6 * gauss(x - (wall - 0.16), sd);
      ru += u[i][0] * f;
      rr += f * f;
    } else {
      const double f = 1e-6 * gauss((x - front) * speed / c, sd);
      tu += u[i][0] * f;
      tt += f * f;
    }
  }
  // Displacements reflect with -R; transmitted pressure is Z_s/Z_m times the transmitted displacement.
  return {-ru / rr, tu / tt * steel_density * c / (mercury_density * speed)};
}

double exact_reflection(double speed) {
  const double zs = steel_density * steel_speed(), zm = mercury_density * speed;
  return (zs - zm) / (zs + zm);
}

}  // namespace

// R = (Z_s - Z_m)/(Z_s + Z_m) = 0.3925 at c = 1450 m/s, 0.3907 at 1456; T = 1 + R (physics.md section 4).
TEST(Interface, ReflectsAndTransmitsAtNormalIncidenceAccordingToTheImpedances) {
  EXPECT_NEAR(exact_reflection(1450), 0.3925, 5e-5);
  EXPECT_NEAR(exact_reflection(1456), 0.3907, 5e-5);
  for (const double speed : {1450., 1456.}) {
    const double r = exact_reflection(speed);
    const auto got = reflection(0.002, speed, 1, 1);
    const auto coarse = reflection(0.004, speed, 1, 1), soft = reflection(0.002, speed, 0.9, 1);
    verify({.item = "Mercury to steel",
            .quantity = fmt::format("R, c = {:.0f} m/s", speed),
            .reference = r,
            .source = "impedances; tabulated 0.3925, 0.3907",
            .measured = got.reflected,
            .tolerance = 0.01 * r,
            .order = observed_order({4, 2}, {coarse.reflected - r, got.reflected - r}),
            .control = "steel 10 % softer",
            .control_value = soft.reflected});
    verify({.item = "Mercury to steel",
            .quantity = fmt::format("T, c = {:.0f} m/s", speed),
            .reference = 1 + r,
            .source = "impedances",
            .measured = got.transmitted,
            .tolerance = 0.01 * (1 + r),
            .control = "steel 10 % softer",
            .control_value = soft.transmitted});
  }
  // The wave passes from mercury with sub-cycles of three steps to mercury without, and back.
  const double r = exact_reflection(1450);
  const auto cycled = reflection(0.002, 1450, 1, 1, false, 3), soft = reflection(0.002, 1450, 0.9, 1, false, 3);
  verify({.item = "Mercury to steel",
          .quantity = "R, c = 1450 m/s, 3 sub-cycles",
          .reference = r,
          .source = "impedances",
          .measured = cycled.reflected,
          .tolerance = 0.01 * r,
          .control = "steel 10 % softer",
          .control_value = soft.reflected});
  verify({.item = "Mercury to steel",
          .quantity = "T, c = 1450 m/s, 3 sub-cycles",
          .reference = 1 + r,
          .source = "impedances",
          .measured = cycled.transmitted,
          .tolerance = 0.01 * (1 + r),
          .control = "steel 10 % softer",
          .control_value = soft.transmitted});
  const auto tied = reflection(0.002, 1450, 1, 1, true);  // at normal incidence slip makes no difference
  EXPECT_NEAR(tied.reflected, reflection(0.002, 1450, 1, 1).reflected, 1e-6);
}

TEST(Interface, ControlsFail) {
  const double r = exact_reflection(1450);
  EXPECT_GT(std::abs(reflection(0.002, 1450, 0.9, 1).reflected - r), 0.02 * r);  // a softer steel
  EXPECT_NEAR(reflection(0.002, 1450, 1, 0).reflected, -1, 0.01);                // pairs with zero normals: a free surface
}
