// Bars: free-fixed frequencies, and the Pochhammer-Chree dispersion of the round bar (physics.md section 4).
#include "forward/mesh/make_mesh.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {
double bar_speed(double modulus = young) { return std::sqrt(modulus / steel_density); }
}  // namespace

// f_n = (2 n - 1) c0 / 4 L of a slender bar with one end held.
TEST(Bar, FreeFixedFrequencies) {
  const double length = 0.4;
  Mesh mesh = block({80, 1, 1}, {0, 0, 0}, {length, 0.004, 0.004}, Region::steel);
  fix(mesh, 1, plane(0, 0)), fix(mesh, 2, plane(1, 0)), fix(mesh, 4, plane(2, 0));
  const auto frequency = [&](int n, const LinearElastic& moduli) {
    const double exact = (2 * n - 1) * bar_speed() / (4 * length), k = (2 * n - 1) * M_PI / (2 * length);
    RunSetup s = linear_setup(4 / exact, 0.02 / exact);
    s.steel = moduli;
    s.initial_displacement = field(mesh, [&](const Vec3& x) { return Vec3{1e-6 * std::sin(k * x[0]), -1e-6 * poisson * k * std::cos(k * x[0]) * x[1], -1e-6 * poisson * k * std::cos(k * x[0]) * x[2]}; });
    const std::vector<ObservationRow> rows{component(nearest(mesh, {length, 0, 0}), 0)};
    const auto out = ExplicitSolver(mesh, moduli).solve(s, rows, {});
    return fitted_frequency(out.times, row_of(out, 0), 0.8 * exact, 1.2 * exact) / exact - 1;
  };
  for (const int n : {1, 2, 3}) {
    const double error = frequency(n, steel());
    measured("free_fixed_error_" + std::to_string(n), error);
    EXPECT_LT(std::abs(error), 1e-3) << n;
  }
  EXPECT_GT(frequency(1, LinearElastic::from_young(1.01 * young, poisson)), 4e-3);  // control
}

// First longitudinal mode of a round bar, nu = 0.29 (Pochhammer 1876, Chree 1889; table of physics.md section 4): a bar whose
// plane ends cannot move along x swings exactly in the mode with k = pi / L; its frequency gives c / c0 = Omega / (k a).
namespace {
double phase_speed(double omega, double ratio, double nu, double size) {
  const double a = 0.01, ka = omega / ratio, k = ka / a, f = omega * bar_speed() / (2 * M_PI * a);
  const LinearElastic moduli = LinearElastic::from_young(young, nu);
  GeometryOptions g;
  g.kind = "bar", g.radius = a, g.length = M_PI / k, g.element_size = size * a;
  Mesh mesh = make_mesh(g);
  fix(mesh, 1, plane(0, 0)), fix(mesh, 1, plane(0, *g.length));
  RunSetup s = linear_setup(6 / f, 0.05 / f);
  s.steel = moduli;
  s.initial_displacement = field(mesh, [&](const Vec3& x) { return Vec3{1e-6 * std::sin(k * x[0]), -1e-6 * nu * k * std::cos(k * x[0]) * x[1], -1e-6 * nu * k * std::cos(k * x[0]) * x[2]}; });
  const std::vector<ObservationRow> rows{component(nearest(mesh, {*g.length / 2, 0, 0}), 0)};
  const auto out = ExplicitSolver(mesh, moduli).solve(s, rows, {});
  return 2 * M_PI * a / bar_speed() * fitted_frequency(out.times, row_of(out, 0), 0.9 * f, 1.1 * f) / ka;
}
}  // namespace

TEST(Bar, PochhammerChreeDispersion) {
  const std::array<std::pair<double, double>, 4> table{{{.26, .9986}, {.50, .9944}, {.74, .9869}, {.98, .9747}}};
  for (const auto& [omega, ratio] : table) {
    const double got = phase_speed(omega, ratio, poisson, 0.2);
    measured("c_over_c0_at_" + std::to_string(omega).substr(0, 4), got);
    EXPECT_NEAR(got, ratio, 2e-3) << omega;
  }
  // Halving the elements takes most of the error away.
  const double coarse = phase_speed(.98, .9747, poisson, 0.25), fine = phase_speed(.98, .9747, poisson, 0.125);
  measured("c_over_c0_at_0.98_a_over_4", coarse), measured("c_over_c0_at_0.98_a_over_8", fine);
  EXPECT_LT(std::abs(fine - .9747), 0.5 * std::abs(coarse - .9747));
  // Control: Poisson's ratio 0.25 disperses less.
  EXPECT_GT(phase_speed(.98, .9747, 0.25, 0.2), .9747 + 2e-3);
}
