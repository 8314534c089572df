#include "forward/mechanism/rear_reflection.hpp"

#include "tests/unit/forward/mechanism/column.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

constexpr double length = 0.2;

RunSetup with_coefficient(double r, double end, double interval) {
  RunSetup s = linear_setup(end, interval);
  const auto entry = rear_reflection();
  entry.setup(values_of(entry, {{"coefficient", r}}), s);
  return s;
}

}  // namespace

// A pulse returns with r times its pressure and -r times its displacement.
TEST(RearReflection, APlanePulseComesBackWithTheCoefficient) {
  const double sd = 0.01, from = 0.1;
  Mesh mesh = column(400, length, Region::mercury);
  mesh.rear = faces_at(mesh, 0, length);
  const auto bell = [&](double x) { return std::exp(-0.5 * std::pow((x - from) / sd, 2)); };
  for (const double r : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    RunSetup s = with_coefficient(r, length / mercury_speed, length / mercury_speed);  // time to the rear and back to its first place
    s.initial_displacement = field(mesh, [&](const Vec3& x) { return Vec3{1e-6 * bell(x[0]), 0, 0}; });
    s.initial_velocity = field(mesh, [&](const Vec3& x) { return Vec3{1e-6 * mercury_speed * (x[0] - from) / (sd * sd) * bell(x[0]), 0, 0}; });
    const auto u = final_displacement(mesh, ExplicitSolver(mesh, steel()).solve(s, all_components(mesh), {}));
    double come = 0, sent = 0;
    for (std::size_t n = 0; n < u.size(); ++n) come += u[n][0] * bell(mesh.nodes[n][0]), sent += 1e-6 * std::pow(bell(mesh.nodes[n][0]), 2);
    measured("come_back_at_" + std::to_string(r), -come / sent);
    EXPECT_NEAR(-come / sent, r, 0.01);
  }
}

// Liquid that is heated evenly pushes on the rear with its pressure only, so that everything remains at rest for any r.
TEST(RearReflection, UniformlyHeatedMercuryRemainsAtRest) {
  Mesh mesh = column(50, length, Region::mercury);
  fix(mesh, 1, plane(0, 0));
  mesh.rear = faces_at(mesh, 0, length);
  for (const double r : {-0.5, 0.5, 1.0}) {
    RunSetup s = with_coefficient(r, 1e-4, 1e-6);
    s.p0.assign(mesh.elements.size(), 20e6), s.p0_at = [](const Vec3&) { return 20e6; }, s.pulse_length = 0.7e-6;
    const std::vector<ObservationRow> rows{component(nearest(mesh, {length, 0, 0}), 0)};
    for (const double x : ExplicitSolver(mesh, steel()).solve(s, rows, {}).observations) EXPECT_LT(std::abs(x), 1e-16);
  }
}

// Under a sudden push on a nearly rigid wall the face gives way once and does not oscillate from step to step.
TEST(RearReflection, TheFaceDoesNotTremble) {
  Mesh mesh = column(100, length, Region::mercury);
  mesh.rear = faces_at(mesh, 0, length);
  for (const double r : {0.0, 0.5, 0.95}) {
    RunSetup s = with_coefficient(r, 5e-5, 5e-5);
    s.initial_velocity = field(mesh, [](const Vec3&) { return Vec3{1e-3, 0, 0}; });
    SolveOptions o;
    o.every_step = true;
    const auto out = ExplicitSolver(mesh, steel()).solve(s, std::vector<ObservationRow>{component(nearest(mesh, {length, 0, 0}), 0)}, o);
    const auto u = row_of(out, 0);
    double trembling = 0;
    for (std::size_t n = 12; n < 30; ++n) trembling = std::max(trembling, std::abs(u[n + 1] - 2 * u[n] + u[n - 1]) / out.time_step);
    measured("trembling_at_" + std::to_string(r), trembling / 1e-3);
    EXPECT_LT(trembling, 0.03 * 1e-3) << r;
  }
}
