// Flexural waves of a steel plate with mercury (c = 1456 m/s) on one side (physics.md section 4). Tabulated: thin plate,
// (D k^4 - m w^2) sqrt(k^2 - w^2/c^2) = rho w^2. That leaves out shear and rotary inertia, k h = 0.19 to 0.52 here, up to 3 %; the reference is
// the same problem with the plate as an elastic layer (Lamb 1917) under mercury of the mesh's depth with a rigid lid.
#include <fmt/format.h>

#include "tests/verification/roots.hpp"
#include "tests/verification/rows.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

constexpr double speed = 1456;

double thin_plate(double h, double k) {
  const double rigidity = young * h * h * h / (12 * (1 - poisson * poisson));
  return bisect(
      [&](double f) {
        const double w2 = std::pow(2 * M_PI * f, 2);
        return (rigidity * std::pow(k, 4) - steel_density * h * w2) * std::sqrt(k * k - w2 / (speed * speed)) - mercury_density * w2;
      },
      1, 1e4);
}

/// phi = A cosh + B sinh (alpha z), psi = C cosh + D sinh (beta z); u_x = (-k phi - psi') sin kx, u_z = (phi' + k psi) cos kx. No shear on either
/// face, no normal stress below, sigma_zz = rho w^2 u_z coth(kappa depth)/kappa above.
double elastic_layer(double h, double k, double depth) {
  const auto m = steel();
  const auto determinant = [&](double f) {
    const double w2 = std::pow(2 * M_PI * f, 2), alpha = std::sqrt(k * k - w2 * steel_density / m.longitudinal_modulus()),
                 beta = std::sqrt(k * k - w2 * steel_density / m.mu);
    const double kappa = std::sqrt(k * k - w2 / (speed * speed));
    Eigen::Matrix4d rows;
    for (const int side : {0, 1}) {
      const double z = side == 0 ? -h / 2 : h / 2;
      const Eigen::Vector4d phi(std::cosh(alpha * z), std::sinh(alpha * z), 0, 0), phi1(alpha * std::sinh(alpha * z), alpha * std::cosh(alpha * z), 0, 0);
      const Eigen::Vector4d psi(0, 0, std::cosh(beta * z), std::sinh(beta * z)), psi1(0, 0, beta * std::sinh(beta * z), beta * std::cosh(beta * z));
      Eigen::Vector4d normal = m.lambda * (alpha * alpha - k * k) * phi + 2 * m.mu * (alpha * alpha * phi + k * psi1);
      if (side == 1) normal -= mercury_density * w2 / (kappa * std::tanh(kappa * depth)) * (phi1 + k * psi);
      rows.row(2 * side) = normal / (m.mu * k * k);
      rows.row(2 * side + 1) = (-2 * k * phi1 - (beta * beta + k * k) * psi) / (k * k);
    }
    return rows.determinant();
  };
  return bisect(determinant, 0.7 * thin_plate(h, k), 1.1 * thin_plate(h, k));
}

/// Half a wavelength between symmetry planes in n elements, with n / 8 through the plate, and mercury in layers that grow away from it.
double solver_frequency(double h, double half, double depth, int n, double stiffness = 1) {
  const double k = M_PI / half;
  const int layers = n + 4, through = n / 8;
  Mesh m = block({n, 1, through + layers}, {0, 0, -double(through)}, {half, half / n, double(layers)},
                 [](const Vec3& x) { return x[2] < 0 ? Region::steel : Region::mercury; });
  // The spacing is quadratic: the layer on the plate is at most half / n thick.
  for (auto& x : m.nodes) x[2] = x[2] <= 0 ? x[2] * h / through : depth * (0.35 * x[2] / layers + 0.65 * std::pow(x[2] / layers, 2));
  m.liquid_element_size = half / n;
  fix(m, 2, everywhere());
  fix(m, 1, plane(0, 0));
  fix(m, 1, plane(0, half));
  fix(m, 4, plane(2, depth));
  split(m, {{0, 0, 1}});
  const LinearElastic moduli = LinearElastic::from_young(stiffness * young, poisson);
  const double period = 1 / thin_plate(h, k);
  RunSetup s = linear_setup(2.5 * period, period / 40);
  s.steel = moduli;
  s.liquid.bulk_modulus = mercury_density * speed * speed;
  s.initial_velocity.resize(m.nodes.size());
  std::vector<bool> liquid(m.nodes.size(), false);
  for (std::size_t e = 0; e < m.elements.size(); ++e)
    if (m.region[e] == Region::mercury)
      for (const NodeId i : m.elements[e]) liquid[std::size_t(i)] = true;
  for (std::size_t i = 0; i < m.nodes.size(); ++i) {
    const auto& x = m.nodes[i];
    const double c = std::cos(k * x[0]), sine = std::sin(k * x[0]), decay = std::exp(-k * x[2]);
    s.initial_velocity[i] = liquid[i] ? Vec3{sine * decay, 0, c * decay} : Vec3{k * sine * (x[2] + h / 2), 0, c};
  }
  const std::vector<ObservationRow> rows{component(nearest(m, {0, 0, -h}), 2)};
  const auto out = ExplicitSolver(m, moduli).solve(s, rows, {});
  return fitted_frequency(out.times, row_of(out, 0), 0.7 / period, 1.3 / period);
}

}  // namespace

// 0.1 % is allowed, as (k h)^2 / 12 of half a wave in 32 elements. The mercury's hourglass springs, 0.0005 of K, are K k^2 / (rho w^2), up to 280 times,
// stiffer than the flow: a coefficient of 0.005 puts 0.06 to 0.41 % on the same frequencies.
TEST(WetBending, FlexuralWavesUnderMercuryAreThoseOfTheElasticLayer) {
  struct Case {
    double h, half, tabulated;
  };
  for (const auto& c : {Case{0.003, 0.03, 3064}, Case{0.003, 0.05, 885}, Case{0.005, 0.03, 6214}, Case{0.005, 0.05, 1838}}) {
    const double k = M_PI / c.half, depth = 1.8 * c.half, thin = thin_plate(c.h, k), exact = elastic_layer(c.h, k, depth);
    EXPECT_NEAR(thin, c.tabulated, 0.6);
    const double coarse = solver_frequency(c.h, c.half, depth, 16), fine = solver_frequency(c.h, c.half, depth, 32);
    verify({.item = "Wet flexural waves",
            .quantity = fmt::format("h {:.0f} mm, wavelength {:.0f} mm", 1e3 * c.h, 2e3 * c.half),
            .unit = "Hz",
            .reference = exact,
            .source = fmt::format("elastic layer, exact root; thin plate, tabulated, {:.0f} Hz ({:+.1f} %)", c.tabulated, 100 * (thin / exact - 1)),
            .measured = fine,
            .tolerance = 0.001 * exact,
            .order = observed_order({1, 0.5}, {coarse / exact - 1, fine / exact - 1}),
            .control = "modulus of the plate +4 %",
            .control_value = solver_frequency(c.h, c.half, depth, 16, 1.04)});
  }
}
