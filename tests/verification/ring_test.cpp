// A steel ring of 50 mm inner radius filled with mercury, plane strain, breathing modes (physics.md section 4). Exact: in the steel
// u = A J1(k_L r) + B Y1(k_L r), k_L = omega / c_L; in the mercury p = P J0(k r), k = omega / c; radial stress and motion common at R.
#include <fmt/format.h>

#include "forward/mesh/section.hpp"
#include "tests/verification/disc_section.hpp"
#include "tests/verification/roots.hpp"
#include "tests/verification/rows.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

constexpr double radius = 0.05, speed = 1456;

std::vector<double> exact_frequencies(double h, int count) {
  const auto m = steel();
  const auto residue = [&](double f) {
    const double w = 2 * M_PI * f, kl = w / steel_speed(), k = w / speed;
    const auto stress = [&](auto bessel, double r) {  // of u = Z1(k_L r): (lambda + 2 mu) u' + lambda u / r
      const double z1 = bessel(1, kl * r);
      return m.longitudinal_modulus() * (kl * bessel(0, kl * r) - z1 / r) + m.lambda * z1 / r;
    };
    const auto j = [](int n, double x) { return std::cyl_bessel_j(n, x); };
    const auto y = [](int n, double x) { return std::cyl_neumann(n, x); };
    const double A = stress(y, radius + h), B = -stress(j, radius + h);  // no stress outside
    const double u = A * j(1, kl * radius) + B * y(1, kl * radius), sigma = A * stress(j, radius) + B * stress(y, radius);
    // rho omega^2 u = dp/dr = -P k J1, sigma = -p = -P J0
    return sigma * k * j(1, k * radius) - mercury_density * w * w * u * j(0, k * radius);
  };
  auto roots = roots_between(residue, 2000, 60000, 2000);
  roots.resize(std::size_t(count));
  return roots;
}

/// Frequencies of the wall's mean radial motion after a sudden uniform pressure, near the given ones. `n`: quadrilaterals along half a quarter's
/// core, elements of the mercury about pi R / 4 n.
std::vector<double> solver_frequencies(double h, int n, double c, const std::vector<double>& near) {
  const Section section = filled_ring(n, int(1.1 * n), 2, radius, h);
  const double dz = radius / n;
  LayeredLine along(0);
  along.add(dz, 1, Region::mercury);
  AssemblyOptions assembly;
  assembly.boundary = symmetric_quarter(dz);
  Mesh mesh = assemble_mesh(extrude(section, along, [](double p, double q, double c) { return Vec3{c, p, q}; }), assembly);
  fix(mesh, 1, everywhere());
  RunSetup s = linear_setup(2e-3, 2e-6);
  s.liquid.bulk_modulus = mercury_density * c * c;
  s.p0.assign(mesh.elements.size(), 1e6);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    if (mesh.region[e] == Region::steel) s.p0[e] = 0;
  ObservationRow wall;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const double y = mesh.nodes[i][1], z = mesh.nodes[i][2], r = std::hypot(y, z);
    if (r < radius + 0.99 * h) continue;
    const double share = y < 1e-9 || z < 1e-9 ? 0.5 : 1;  // the ends belong to the neighbouring quarters as well
    wall.nodes.push_back(NodeId(i));
    wall.weights.push_back({0, share * y / r, share * z / r});
  }
  const std::vector<ObservationRow> rows{wall};
  const auto out = ExplicitSolver(mesh, steel()).solve(s, rows, {});
  std::vector<double> f;
  for (const double at : near) f.push_back(peak_frequency(out.times, row_of(out, 0), at - 3000, at + 3000));
  return f;
}

}  // namespace

// With elements of about 1.6 mm a radial wave of k = omega / c may err by (k h)^2 / 12, 1.1 % in the highest mode, 0.1 % in the lowest; with
// two elements through the steel another 0.1 %.
TEST(Ring, FilledWithMercuryBreathesAtItsExactFrequencies) {
  const std::vector<std::pair<double, std::vector<double>>> cases{{0.003, {11511, 25048, 38953, 52968}}, {0.005, {11677, 24693, 38244}}};
  for (const auto& [h, tabulated] : cases) {
    const auto exact = exact_frequencies(h, int(tabulated.size()));
    const auto coarse = solver_frequencies(h, 14, speed, exact), fine = solver_frequencies(h, 24, speed, exact);
    const auto slower = solver_frequencies(h, 24, 0.97 * speed, exact);
    const double size = M_PI * radius / (4 * 24);
    for (std::size_t i = 0; i < tabulated.size(); ++i) {
      EXPECT_NEAR(exact[i], tabulated[i], 1.0);
      const double kh = 2 * M_PI * exact[i] / speed * size;
      verify({.item = "Fluid-filled ring",
              .quantity = fmt::format("h {:.0f} mm, mode {}", 1e3 * h, i + 1),
              .unit = "Hz",
              .reference = exact[i],
              .source = fmt::format("exact root; tabulated {:.0f} Hz", tabulated[i]),
              .measured = fine[i],
              .tolerance = exact[i] * (kh * kh / 12 + 1e-3),
              .order = observed_order({1, 14. / 24}, {coarse[i] - exact[i], fine[i] - exact[i]}),
              .control = "speed of sound -3 %",
              .control_value = slower[i]});
    }
  }
}
