// First longitudinal mode of a round bar (Pochhammer 1876, Chree 1889), nu = 0.29. A bar whose plane ends cannot move along x oscillates
// exactly in the mode with k = pi / L; its frequency at that k gives c = omega / k.
#include <fmt/format.h>

#include "forward/mesh/make_mesh.hpp"
#include "tests/verification/roots.hpp"
#include "tests/verification/rows.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

constexpr double a = 0.01;  // radius [m]

double bar_speed() { return std::sqrt(young / steel_density); }

/// u_r = (-A p J1(p r) - B k J1(q r)) cos kx, u_x = (-A k J0(p r) + B q J0(q r)) sin kx, p^2 = omega^2/c_L^2 - k^2 < 0 (so J becomes I),
/// q^2 = omega^2/c_T^2 - k^2 > 0; B : A from the shear stress at r = a, the frequency from the radial stress (Graff 1975, section 8.2).
struct LongitudinalMode {
  double k, s, q, A, B, nu;

  LongitudinalMode(double omega, double wave_number, double ratio) : k(wave_number), nu(ratio) {
    const auto m = LinearElastic::from_young(young, nu);
    s = std::sqrt(k * k - omega * omega * steel_density / m.longitudinal_modulus());
    q = std::sqrt(omega * omega * steel_density / m.mu - k * k);
    A = (q * q - k * k) * std::cyl_bessel_j(1, q * a);
    B = -2 * k * s * std::cyl_bessel_i(1, s * a);
  }
  [[nodiscard]] double radial(double r) const { return A * s * std::cyl_bessel_i(1, s * r) - B * k * std::cyl_bessel_j(1, q * r); }
  [[nodiscard]] double axial(double r) const { return -A * k * std::cyl_bessel_i(0, s * r) + B * q * std::cyl_bessel_j(0, q * r); }
  /// Radial stress at r = a over 2 mu; zero in a mode.
  [[nodiscard]] double radial_stress() const {
    const double lambda = nu / (1 - 2 * nu);  // over 2 mu
    const double dilatation = A * (s * s - k * k) * std::cyl_bessel_i(0, s * a);
    const double slope = A * s * (s * std::cyl_bessel_i(0, s * a) - std::cyl_bessel_i(1, s * a) / a) -
                         B * k * (q * std::cyl_bessel_j(0, q * a) - std::cyl_bessel_j(1, q * a) / a);
    return lambda * dilatation + slope;
  }
};

/// c / c0 of the first mode at Omega = omega a / c0.
double exact_ratio(double omega, double nu = poisson) {
  const double w = omega * bar_speed() / a;
  return bisect([&](double ratio) { return LongitudinalMode(w, omega / (ratio * a), nu).radial_stress(); }, 0.65, 1 - 1e-6);
}

/// c / c0 of the solver at the wave number of (omega, ratio), with elements of `size` radii.
double solver_ratio(double omega, double ratio, double nu, double size, double stiffness = 1) {
  const double ka = omega / ratio, k = ka / a, w = omega * bar_speed() / a, period = 2 * M_PI / w;
  const LinearElastic moduli = LinearElastic::from_young(stiffness * young, nu);
  const LongitudinalMode mode(w, k, poisson);
  GeometryOptions g;
  g.kind = "bar";
  g.radius = a;
  g.length = M_PI / k;
  g.element_size = size * a;
  Mesh mesh = make_mesh(g);
  fix(mesh, 1, plane(0, 0));
  fix(mesh, 1, plane(0, *g.length));
  RunSetup s = linear_setup(6 * period, period / 20);
  s.steel = moduli;
  const double scale = 1e-6 / std::abs(mode.axial(0));
  s.initial_displacement = field(mesh, [&](const Vec3& x) {
    const double r = std::hypot(x[1], x[2]), radial = r > 0 ? scale * mode.radial(r) / r * std::cos(k * x[0]) : 0;
    return Vec3{scale * mode.axial(r) * std::sin(k * x[0]), radial * x[1], radial * x[2]};
  });
  const std::vector<ObservationRow> rows{component(nearest(mesh, {*g.length / 2, 0, 0}), 0)};
  const auto out = ExplicitSolver(mesh, moduli).solve(s, rows, {});
  return 2 * M_PI * a / bar_speed() * fitted_frequency(out.times, row_of(out, 0), 0.85 / period, 1.15 / period) / ka;
}

constexpr std::array<std::pair<double, double>, 8> table{
    {{.26, .9986}, {.50, .9944}, {.74, .9869}, {.98, .9747}, {1.22, .9545}, {1.46, .9196}, {1.70, .8547}, {1.94, .7594}}};

}  // namespace

// In a quarter bar with elements of h = a / 6 a wave of this length may err by (k h)^2 / 12 (twice the leading term of lumped linear elements),
// and the table by its last digit.
TEST(RoundBar, DispersesAsPochhammerAndChree) {
  std::vector<double> omegas, exact, got;
  for (const auto& [omega, tabulated] : table) {
    const double root = exact_ratio(omega), ka = omega / root;
    EXPECT_NEAR(root, tabulated, 2e-4) << omega;  // table and root finder: the table scatters about the root, +1.7e-4 at 1.46, -1.1e-4 at 1.70
    const double coarse = solver_ratio(omega, root, poisson, 1. / 4), fine = solver_ratio(omega, root, poisson, 1. / 6);
    verify({.item = "Pochhammer-Chree",
            .quantity = fmt::format("c/c0 at {:.2f}", omega),
            .reference = root,
            .source = fmt::format("exact root; tabulated {:.4f}", tabulated),
            .measured = fine,
            .tolerance = ka * ka / 36 / 12 + 1e-4,
            .order = observed_order({1. / 4, 1. / 6}, {coarse - root, fine - root}),
            .control = "modulus -5 %",
            .control_value = solver_ratio(omega, root, poisson, 1. / 6, 0.95)});
    omegas.push_back(omega);
    got.push_back(fine);
  }
  const double root = exact_ratio(1.22);
  std::vector<double> errors;
  for (const double size : {1. / 4, 1. / 6, 1. / 8}) errors.push_back(solver_ratio(1.22, root, poisson, size) / root - 1);
  EXPECT_GT(drawn_order("round bar at 1.22", {1, 4. / 6, 0.5}, errors), 1.7);
  EXPECT_GT(solver_ratio(.98, exact_ratio(.98), 0.20, 1. / 6), .9747 + 0.005);  // control: a smaller Poisson's ratio disperses less
  std::vector<double> w;
  for (double o = 0.1; o < 2; o += 0.02) w.push_back(o), exact.push_back(exact_ratio(o));
  draw("pochhammer_chree", "exact, first mode", w, exact);
  draw("pochhammer_chree", "solver, a/6 (points)", omegas, got);
}
