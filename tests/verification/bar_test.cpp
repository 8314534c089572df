// A slender bar, free at one end and held at the other (physics.md section 4).
#include "tests/verification/rows.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {
double bar_speed(double modulus = young) { return std::sqrt(modulus / steel_density); }
}  // namespace

// f_n = (2 n - 1) c0 / 4 L of a slender bar with one end held.
TEST(Bar, FreeFixedFrequencies) {
  const double length = 0.4;
  const auto frequency = [&](int n, int elements, const LinearElastic& moduli) {
    Mesh mesh = block({elements, 1, 1}, {0, 0, 0}, {length, 0.004, 0.004}, Region::steel);
    fix(mesh, 1, plane(0, 0));
    fix(mesh, 2, plane(1, 0));
    fix(mesh, 4, plane(2, 0));
    const double exact = (2 * n - 1) * bar_speed() / (4 * length), k = (2 * n - 1) * M_PI / (2 * length);
    RunSetup s = linear_setup(4 / exact, 0.02 / exact);
    s.steel = moduli;
    s.initial_displacement = field(mesh, [&](const Vec3& x) {
      return Vec3{1e-6 * std::sin(k * x[0]), -1e-6 * poisson * k * std::cos(k * x[0]) * x[1], -1e-6 * poisson * k * std::cos(k * x[0]) * x[2]};
    });
    const std::vector<ObservationRow> rows{component(nearest(mesh, {length, 0, 0}), 0)};
    const auto out = ExplicitSolver(mesh, moduli).solve(s, rows, {});
    return fitted_frequency(out.times, row_of(out, 0), 0.8 * exact, 1.2 * exact);
  };
  // With 80 elements mode 3 may err by (k h)^2 / 12 = 0.02 %, and by lateral inertia (Rayleigh), (nu k)^2 times the mean square radius, 0.01 %.
  for (const int n : {1, 2, 3}) {
    const double exact = (2 * n - 1) * bar_speed() / (4 * length), coarse = frequency(n, 20, steel()), middle = frequency(n, 40, steel()),
                 fine = frequency(n, 80, steel());
    verify({.item = "Free-fixed bar",
            .quantity = "f" + std::to_string(n),
            .unit = "Hz",
            .reference = exact,
            .source = "(2 n - 1) c0 / 4 L",
            .measured = fine,
            .tolerance = 1e-3 * exact,
            .order = observed_order({4, 2}, {coarse - exact, middle - exact}),
            .control = "modulus +1 %",
            .control_value = frequency(n, 80, LinearElastic::from_young(1.01 * young, poisson))});
  }
}
