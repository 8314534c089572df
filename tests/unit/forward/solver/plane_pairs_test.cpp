// In plane strain half of the nodes determine the motion. The tests check the pairs of nodes, and compare runs on pairs in lanes with runs on hexahedra.
#include "forward/solver/plane_pairs.hpp"

#include <array>
#include <cmath>
#include <memory>

#include "base/random.hpp"
#include "forward/mesh/make_mesh.hpp"
#include "forward/solver/layout.hpp"
#include "forward/solver/liquid_law.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

/// A slice with walls round its mercury except at the rear, which is non-reflecting; `distorted`: no element is a parallelepiped.
Mesh slice(bool distorted) {
  GeometryOptions g;
  g.kind = "box";
  g.length = 0.03;
  g.width = 0.02;
  g.height = 0.02;
  g.wall = 0.004;
  g.plane_strain = true;
  g.element_size = 0.002;
  Mesh mesh = make_mesh(g);
  for (auto& x : mesh.nodes) x[1] *= 5;  // so that the shortest edges lie in the plane, whether or not plane strain is declared
  if (!distorted) return mesh;
  for (auto& x : mesh.nodes) {  // the same on both faces; nodes on a face remain in it
    const double bump = 6e-4 * std::sin(M_PI * x[0] / 0.03) * std::sin(M_PI * (x[2] - 0.004) / 0.012) * std::sin(M_PI * x[2] / 0.02);
    if (x[2] > 0.0041 && x[2] < 0.0159 && x[0] > 0.0041) x[0] += bump, x[2] -= 0.5 * bump;
  }
  return mesh;
}

RunSetup pulse(const Mesh& mesh, double cutoff) {
  RunSetup s = linear_setup(6e-5, 1e-6);
  s.liquid.viscosity = 500;
  s.pulse_length = 1e-6;
  s.energies = {0.98, 1, 1.03};
  s.liquid.tensile_cutoff = s.wetted_cutoff = cutoff;
  for (const auto& e : mesh.elements) {
    const Vec3& x = mesh.nodes[std::size_t(e[0])];
    s.p0.push_back(2e7 * std::exp(-std::pow((x[2] - 0.012) / 0.006, 2) - x[0] / 0.05));
  }
  s.p0_at = [](const Vec3& x) { return 2e7 * std::exp(-std::pow((x[2] - 0.012) / 0.006, 2) - x[0] / 0.05); };
  return s;
}

std::vector<double> histories(const Mesh& mesh, const RunSetup& s, const SolveOptions& o) {
  std::vector<ObservationRow> rows;
  for (const Vec3& x : {Vec3{0, 0, 0.01}, Vec3{0.015, 0, 0.02}, Vec3{0.015, 0.01, 0.02}, Vec3{0.02, 0, 0.01}, Vec3{0.03, 0.01, 0.01}})
    for (const int axis : {0, 2}) rows.push_back(component(nearest(mesh, x), axis));
  return ExplicitSolver(mesh, steel()).solve(s, rows, o).observations;
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double d = 0, n = 0;
  for (std::size_t i = 0; i < a.size(); ++i) d += std::pow(a[i] - b[i], 2), n += std::pow(b[i], 2);
  EXPECT_GT(n, 0);
  return std::sqrt(d / n);
}

/// The mesh as hexahedra, with or without pairs.
Mesh solid(Mesh mesh) {
  mesh.plane_strain = false;
  return mesh;
}

/// Relative difference of all histories between pairs of nodes and hexahedra.
double difference(const Mesh& mesh, const RunSetup& s, const SolveOptions& o = {}) { return difference(histories(mesh, s, o), histories(solid(mesh), s, o)); }

/// Relative change of the histories by hexahedra for so small a relative change of the pulse: after the first cavitation the motion is chaotic.
double chaos(const Mesh& mesh, RunSetup s, double share) {
  const auto before = histories(solid(mesh), s, {});
  for (auto& e : s.energies) e *= 1 + share;
  return difference(histories(solid(mesh), s, {}), before);
}

constexpr double rounding = 1e-10;  ///< growth over some 500 steps

/// A liquid law that softens by up to half, the more so the more the liquid was strained.
class Softer : public LiquidLaw {
 public:
  explicit Softer(double bulk_modulus) : bulk_modulus_(bulk_modulus) {}
  std::size_t state_size() const override { return 1; }
  void initialise(std::span<const Vec3>, double*, std::size_t) const override {}
  void advance(const LiquidPoints& p) const override {
    for (std::size_t i = 0; i < p.count; ++i) {
      p.state[i] = std::max(p.state[i], std::abs(p.strain[i]));
      p.pressure[i] = p.heating[i] - 0.5 * bulk_modulus_ / (1 + 100 * p.state[i]) * p.strain[i];
    }
  }

 private:
  double bulk_modulus_;
};

}  // namespace

TEST(PlanePairs, HalfOfTheNodesOfASliceLead) {
  const Mesh mesh = slice(false);
  const PlanePairs pairs = plane_pairs(mesh);
  ASSERT_TRUE(pairs);
  std::size_t leaders = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const auto& x = mesh.nodes[n];
    const auto& y = mesh.nodes[std::size_t(pairs.of(NodeId(n)))];
    EXPECT_EQ(pairs.of(pairs.of(NodeId(n))), pairs.of(NodeId(n)));
    EXPECT_NEAR(x[0], y[0], 1e-15);
    EXPECT_NEAR(x[2], y[2], 1e-15);
    EXPECT_LE(y[1], x[1]);
    leaders += pairs.of(NodeId(n)) == NodeId(n);
  }
  EXPECT_EQ(2 * leaders, mesh.nodes.size());
  const Layout layout = make_layout(mesh, std::vector<std::uint8_t>(mesh.elements.size(), 1), 256, {}, pairs);
  EXPECT_EQ(std::size_t(layout.nodes), leaders);
  // Faces at the rear count with both of their nodes.
  double area = 0;
  for (const auto& n : layout.rear) area += n.area[0];
  EXPECT_NEAR(area, 0.01 * 0.012, 1e-15);
}

TEST(PlanePairs, ThereAreNoneWhereNodesMayMoveApart) {
  EXPECT_FALSE(plane_pairs(block({2, 1, 2}, {0, 0, 0}, {1, 1, 1}, Region::steel)));  // plane strain is not declared
  Mesh free = slice(false);
  for (auto& f : free.fixed) f = std::uint8_t(f & ~2);
  EXPECT_FALSE(plane_pairs(free));
  Mesh askew = slice(false);
  askew.nodes[std::size_t(nearest(askew, {0.01, 0, 0.01}))][0] += 1e-6;
  EXPECT_FALSE(plane_pairs(askew));
  Mesh held = slice(false);
  held.fixed[std::size_t(nearest(held, {0.01, 0, 0.01}))] |= 1;
  EXPECT_FALSE(plane_pairs(held));
  Mesh two_across = block({2, 2, 2}, {0, 0, 0}, {1, 1, 1}, Region::steel);
  two_across.plane_strain = true;
  fix(two_across, 2, everywhere());
  EXPECT_FALSE(plane_pairs(two_across));
}

TEST(PlanePairs, AnyAxisOfAnElementMayRunAcross) {
  for (const std::uint8_t across : {0, 1, 2})
    for (const auto k : plane_corners(across)) EXPECT_EQ(k & (1 << across), 0);
  // The same slice with the axes of its elements in cyclic order.
  const Mesh mesh = slice(true);
  const RunSetup s = pulse(mesh, 1e15);
  for (int turn = 0; turn < 3; ++turn) {
    Mesh turned = mesh;
    for (auto& e : turned.elements) {
      const auto was = e;
      for (unsigned k = 0; k < 8; ++k) e[((k << turn) | (k >> (3 - turn))) & 7u] = was[k];
    }
    EXPECT_EQ(plane_pairs(turned).across[0], (1 + turn) % 3);
    EXPECT_LT(difference(turned, s), rounding) << turn;
  }
}

TEST(PlanePairs, RunsInTheLanesAreThoseOfHexahedra) {
  for (const bool distorted : {false, true}) {
    const Mesh mesh = slice(distorted);
    EXPECT_LT(difference(mesh, pulse(mesh, 1e15)), rounding);
    const RunSetup parting = pulse(mesh, 1e5);
    EXPECT_LT(difference(mesh, parting), chaos(mesh, parting, 1e-12));
    EXPECT_LT(difference(mesh, parting, {.precision = "single"}), 0.03);
    RunSetup s = parting;
    s.collapse_viscosity = 0.5;
    s.wall_film = 5e-5;
    EXPECT_LT(difference(mesh, s), chaos(mesh, s, 1e-12));
    s = pulse(mesh, 1e15);
    s.liquid_law = std::make_shared<Softer>(s.liquid.bulk_modulus);
    EXPECT_LT(difference(mesh, s), rounding);
    s = pulse(mesh, 1e15);
    s.steel_mass_damping = 1e4;
    s.steel_stiffness_damping = 1e-8;
    s.steel_branches = {{0.02, 1e-5}};
    EXPECT_LT(difference(mesh, s), rounding);
  }
}

TEST(PlanePairs, WithStressHeatAndMotionBeforeTheRun) {
  const Mesh mesh = slice(true);
  RunSetup s = pulse(mesh, 1e15);
  s.thermal_strain.assign(mesh.elements.size(), 0);
  s.initial_stress.assign(mesh.elements.size(), {});
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const double x = mesh.nodes[std::size_t(mesh.elements[e][0])][0];
    if (mesh.region[e] == Region::steel)
      s.thermal_strain[e] = 1e-4 * x / 0.03, s.initial_stress[e] = {2e6, -1e6, 5e5 * x / 0.03, 0, 0, 8e5};
    else
      s.initial_stress[e] = {-3e5, -3e5, -3e5, 0, 0, 0};
  }
  s.initial_velocity = field(mesh, [](const Vec3& x) { return Vec3{10 * x[0] * x[2], 0, 0.1 * x[2]}; });
  EXPECT_LT(difference(mesh, s), rounding);
  // Control: the comparison detects a tenth less of the heat.
  RunSetup cooler = s;
  for (auto& t : cooler.thermal_strain) t *= 0.9;
  const std::vector<ObservationRow> row{component(nearest(mesh, {0.015, 0, 0.02}), 2)};
  const ExplicitSolver solver(mesh, steel());
  const auto a = solver.solve(s, row, {}), b = solver.solve(cooler, row, {});
  EXPECT_GT(std::abs(a.observations.back() - b.observations.back()), 1e-4 * std::abs(a.observations.back()));
}
