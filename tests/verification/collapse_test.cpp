// A cavity closes: cavitated mercury with an even void strain e0 and without strength moves at V against a rigid wall. A front of speed S leaves the
// wall, behind which the liquid is at rest under p: rho S V = p, S (e0 + p/K) = V, so p = K/2 (sqrt(e0^2 + 4 rho V^2/K) - e0) (Rankine and Hugoniot). The
// kinetic energy exceeds the stored energy, rho V^2/2 > p^2/2K: closing is inelastic. Without its own viscosity each element swings back, and on a mesh of any
// size a quarter of the displacement behind the front is missing.
#include <fmt/format.h>

#include "tests/verification/rows.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

constexpr double stretch = 1e-3, thrown = 1, length = 0.1, time_of_front = 1e-4;
constexpr double modulus = mercury_density * mercury_speed * mercury_speed;

struct Front {
  double pressure = modulus / 2 * (std::sqrt(stretch * stretch + 4 * mercury_density * thrown * thrown / modulus) - stretch);
  double speed = thrown / (stretch + pressure / modulus);
  double lost = 0.5 * mercury_density * thrown * thrown - 0.5 * pressure * pressure / modulus;  ///< [J/m^3]
};

/// A run with n elements across the length; side 1 mm.
SolveSummary closing(int n, double collapse_viscosity, bool energies = true) {
  Mesh m = block({n, 1, 1}, {0, 0, 0}, {length, 1e-3, 1e-3}, Region::mercury);
  m.liquid_element_size = length / n;
  fix(m, 2 | 4, everywhere());
  fix(m, 1, plane(0, 0));
  RunSetup s = linear_setup(time_of_front, time_of_front / 100);
  s.liquid.tensile_cutoff = 0;
  s.collapse_viscosity = collapse_viscosity;
  s.initial_displacement = field(m, [](const Vec3& x) { return Vec3{stretch * x[0], 0, 0}; });
  s.initial_velocity = field(m, [](const Vec3& x) { return Vec3{x[0] > 0 ? -thrown : 0, 0, 0}; });
  SolveOptions o;
  // as the step of the steel does for the mercury of a target
  o.energy_balance = energies;
  o.time_step_safety = 0.15;
  return ExplicitSolver(m, steel()).solve(s, std::vector<ObservationRow>{component(nearest(m, {0.04, 0, 0}), 0)}, o);
}

/// Energy dissipated so far behind the front [J].
double lost() {
  const Front front;
  return front.lost * front.speed * time_of_front * 1e-6;
}

}  // namespace

TEST(Collapse, IsInelasticAccordingToTheFront) {
  const Front front;
  const double coarse = closing(25, 0.5).dissipated, fine = closing(100, 0.5).dissipated;
  verify({.item = "Closing cavity",
          .quantity = "energy lost, 1 mm",
          .unit = "J",
          .reference = lost(),
          .source = "Rankine and Hugoniot",
          .measured = fine,
          .tolerance = 0.01 * lost(),
          .order = observed_order({4, 1}, {coarse / lost() - 1, fine / lost() - 1}),
          .control = "without the viscosity of closing",
          .control_value = closing(100, 0).dissipated});
  const auto compressed = [&](double b) { return row_of(closing(100, b), 0).back(); };
  const double place = -0.04 * front.pressure / modulus;
  verify({.item = "Closing cavity",
          .quantity = "displacement behind the front",
          .unit = "m",
          .reference = place,
          .source = "the same",
          .measured = compressed(0.5),
          .tolerance = 1e-3 * std::abs(place),
          .control = "without it",
          .control_value = compressed(0)});
}

TEST(Collapse, DoesNotDependOnWhatIsKept) {
  const auto kept = closing(50, 0.5).observations, not_kept = closing(50, 0.5, false).observations, without = closing(50, 0, false).observations;
  // The two are compiled separately: with AVX2 one of them may contract a product and a sum, which no wave resolves.
  double apart = 0, control = 0, greatest = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    apart = std::max(apart, std::abs(kept[i] - not_kept[i]));
    control = std::max(control, std::abs(without[i] - not_kept[i]));
    greatest = std::max(greatest, std::abs(kept[i]));
  }
  measured("kept_over_not_kept", apart / greatest);
  EXPECT_LT(apart, 1e-12 * greatest);
  EXPECT_GT(control, 1e-2 * greatest);
}

// Liquid that never reaches its cutoff is not affected by it: the bytes are the same, and the step is the same where the cutoff is out of reach.
TEST(Collapse, IsOfLiquidThatHasBeenAtItsCutoffOnly) {
  Mesh m = block({20, 1, 1}, {0, 0, 0}, {0.02, 1e-3, 1e-3}, Region::mercury);
  m.liquid_element_size = 1e-3;
  fix(m, 2 | 4, everywhere());
  fix(m, 1, plane(0, 0));
  const auto run = [&](double b, double cutoff, double interval) {
    RunSetup s = linear_setup(4e-5, interval);
    s.liquid.tensile_cutoff = cutoff;
    s.collapse_viscosity = b;
    s.initial_velocity = field(m, [](const Vec3& x) { return Vec3{-x[0] / 0.02, 0, 0}; });
    return ExplicitSolver(m, steel()).solve(s, std::vector<ObservationRow>{component(nearest(m, {0.02, 0, 0}), 0)}, {});
  };
  const double greatest_tension = 1e8;  // the wave's is below 2e7
  EXPECT_EQ(run(0.5, greatest_tension, 1e-7).observations, run(0, greatest_tension, 1e-7).observations);
  EXPECT_NE(run(0.5, 1e5, 1e-7).observations, run(0, 1e5, 1e-7).observations);  // control
  EXPECT_EQ(run(2, 2 * modulus, 1e-6).steps, run(0, 2 * modulus, 1e-6).steps);
  EXPECT_GT(run(2, greatest_tension, 1e-6).steps, run(0, greatest_tension, 1e-6).steps);
}
