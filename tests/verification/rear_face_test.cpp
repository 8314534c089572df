// The rear face, p = p0 + rho c v_n, behind which the mercury continues.
#include "tests/verification/rows.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

constexpr double length = 0.2;

/// Mercury along x in a rigid channel of this height; rigid wall at x = 0, rear face at the far end.
Mesh channel(int nx, int nz, double height, double long_side = length) {
  const double h = long_side / nx;
  Mesh m = block({nx, 1, nz}, {0, 0, 0}, {long_side, h, height}, Region::mercury);
  fix(m, 1, plane(0, 0));
  fix(m, 2, everywhere());
  fix(m, 4, plane(2, 0));
  fix(m, 4, plane(2, height));
  m.rear = faces_at(m, 0, long_side);
  return m;
}

/// Strain and kinetic energy of the mercury in a snapshot [J].
double energy_of(const Mesh& mesh, const RunSetup& s, const FieldSnapshot& f) {
  double e = 0;
  const auto m = masses(mesh, s);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) e += 0.5 * m[Eigen::Index(n)] * hexahedron::point(f.velocity[n]).squaredNorm();
  for (std::size_t i = 0; i < mesh.elements.size(); ++i)
    e += 0.5 * f.pressure[i] * f.pressure[i] / s.liquid.bulk_modulus * hexahedron::volume(hexahedron::corners(mesh, i));
  return e;
}

/// Energies at the start and at the end of a run [J].
std::pair<double, double> first_and_last_energy(const Mesh& mesh, const RunSetup& s) {
  std::vector<double> energies;
  SolveOptions o;
  o.field_interval = s.output_interval;
  o.on_field = [&](const FieldSnapshot& f) { energies.push_back(energy_of(mesh, s, f)); };
  (void)ExplicitSolver(mesh, steel()).solve(s, {}, o);
  return {energies.front(), energies.back()};
}

}  // namespace

TEST(RearFace, UniformlyHeatedMercuryBeforeItRemainsAtRest) {
  const Mesh mesh = channel(50, 3, 0.012);
  RunSetup s = linear_setup(2e-4, 1e-6);
  const double p0 = 20e6;
  s.p0.assign(mesh.elements.size(), p0);
  s.p0_at = [=](const Vec3&) { return p0; };
  s.pulse_length = 0.7e-6;
  const ExplicitSolver solver(mesh, steel());
  const std::vector<ObservationRow> rows{component(nearest(mesh, {length, 0, 0.004}), 0)};
  SolveOptions o;
  const auto at_rest = solver.solve(s, rows, o);
  const double z = mercury_density * mercury_speed, free_drift = p0 / (2 * z) * 1e-4;
  double greatest = 0;
  for (const double u : at_rest.observations) greatest = std::max(greatest, std::abs(u));

  // Control: with the total pressure on the face the jump -p0/2 starts there, and the face moves at p0/(2 rho c).
  o.heated_rear = false;
  const auto launched = solver.solve(s, rows, o);
  const auto u = row_of(launched, 0);
  const double speed = (u[120] - u[20]) / 1e-4;
  verify({.item = "Rear face",
          .quantity = "motion of uniformly heated mercury before it, over the free drift p0 t / 2 rho c",
          .reference = 0,
          .source = "rest",
          .measured = greatest / free_drift,
          .tolerance = 1e-12,
          .control = "total pressure on the face",
          .control_value = (u[120] - u[20]) / free_drift});
  EXPECT_NEAR(speed, p0 / (2 * z), 0.01 * p0 / (2 * z));
}

TEST(RearFace, ReflectsNothingAtNormalIncidence) {
  const double sd = 0.012;
  double reflected = 0;
  for (const bool open : {true, false}) {
    Mesh mesh = channel(200, 1, 0.001);
    if (!open) mesh.rear.clear();
    RunSetup s = linear_setup(0.2 / mercury_speed, 0.2 / mercury_speed);
    s.initial_displacement = field(mesh, [&](const Vec3& x) { return Vec3{1e-6 * std::exp(-0.5 * std::pow((x[0] - 0.1) / sd, 2)), 0, 0}; });
    s.initial_velocity = field(mesh, [&](const Vec3& x) {
      return Vec3{1e-6 * mercury_speed * (x[0] - 0.1) / (sd * sd) * std::exp(-0.5 * std::pow((x[0] - 0.1) / sd, 2)), 0, 0};
    });
    const auto [before, after] = first_and_last_energy(mesh, s);
    if (open)
      reflected = after / before;
    else {
      EXPECT_NEAR(after / before, 1, 0.02);
      verify({.item = "Rear face",
              .quantity = "reflected energy, normal incidence",
              .reference = 0,
              .source = "none",
              .measured = reflected,
              .tolerance = 1e-3,
              .control = "free face",
              .control_value = after / before});
    }
  }
}

// The mode cos(pi z / H) of a rigid channel is two plane waves at +- theta, tan(theta) = (pi/H)/k_x: each reflects
// (cos theta - 1)/(cos theta + 1), -0.1716 at 45 degrees; the packet's envelope spreads the angle by a few degrees. The face
// averages the velocity over a step, which takes a factor cos(omega dt / 2) off its impedance: 0.186 with half as many elements each way.
TEST(RearFace, ReflectsAtFortyFiveDegreesAsAPlaneWaveConditionDoes) {
  const double height = 0.02, k = M_PI / height, sd = 0.06, start = 0.25, far = 0.5, omega = mercury_speed * k * std::sqrt(2.0);
  const Mesh mesh = channel(500, 20, height, far);
  const double group = mercury_speed / std::sqrt(2.0), time = 2 * (far - start) / group;
  RunSetup s = linear_setup(time, time);
  // phi = G(x - group t) cos(k z) cos(k x - omega t), displacement = grad phi.
  const auto bell = [&](double x) { return 1e-8 * std::exp(-0.5 * std::pow((x - start) / sd, 2)); };
  const auto slope = [&](double x) { return -(x - start) / (sd * sd); };  // G' / G
  const auto curve = [&](double x) { return slope(x) * slope(x) - 1 / (sd * sd); };
  s.initial_displacement = field(mesh, [&](const Vec3& x) {
    const double g = bell(x[0]), c = std::cos(k * x[0]), n = std::sin(k * x[0]);
    return Vec3{g * std::cos(k * x[2]) * (slope(x[0]) * c - k * n), 0, -k * std::sin(k * x[2]) * g * c};
  });
  s.initial_velocity = field(mesh, [&](const Vec3& x) {
    // d phi/dt = (-group G' cos + omega G sin) cos(k z)
    const double g = bell(x[0]), c = std::cos(k * x[0]), n = std::sin(k * x[0]);
    const double rate = -group * slope(x[0]) * c + omega * n;
    const double along = -group * (curve(x[0]) * c - slope(x[0]) * k * n) + omega * (slope(x[0]) * n + k * c);
    return Vec3{g * along * std::cos(k * x[2]), 0, -k * std::sin(k * x[2]) * g * rate};
  });
  const auto [before, after] = first_and_last_energy(mesh, s);
  const double got = std::sqrt(after / before), theory = (1 - std::sqrt(0.5)) / (1 + std::sqrt(0.5));
  // The packet's envelope spreads the angle by k_x sd = 9 wave lengths, some 3 degrees: 5 % is allowed.
  verify({.item = "Rear face",
          .quantity = "reflection at 45 degrees, size",
          .reference = theory,
          .source = "(1 - cos theta) / (1 + cos theta)",
          .measured = got,
          .tolerance = 0.05 * theory,
          .control = "theory at 50 degrees",
          .control_value = (1 - std::cos(50 * M_PI / 180)) / (1 + std::cos(50 * M_PI / 180))});
}
