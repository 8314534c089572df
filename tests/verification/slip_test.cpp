// Mercury slides along steel: the two nodes of a slip pair have separate tangential velocities and a common normal velocity.
#include "forward/mesh/make_mesh.hpp"
#include "tests/verification/rows.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

/// 6 mm of steel below 12 mm of mercury, 20 mm square; free otherwise.
Mesh layers(bool slip) {
  Mesh m = block({8, 8, 9}, {0, 0, 0}, {0.02, 0.02, 0.018}, [](const Vec3& x) { return x[2] < 0.006 ? Region::steel : Region::mercury; });
  if (slip) split(m, {{0, 0, 1}});
  return m;
}

struct Motion {
  std::vector<Vec3> displacement;
  std::vector<bool> liquid;
};

/// All mercury starts with this velocity, the steel at rest.
Motion slide(const Mesh& mesh, const Vec3& velocity, double end) {
  RunSetup s = linear_setup(end, end);
  Motion m;
  m.liquid.assign(mesh.nodes.size(), false);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    if (mesh.region[e] == Region::mercury)
      for (const NodeId n : mesh.elements[e]) m.liquid[std::size_t(n)] = true;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) s.initial_velocity.push_back(m.liquid[n] ? velocity : Vec3{});
  m.displacement = final_displacement(mesh, ExplicitSolver(mesh, steel()).solve(s, all_components(mesh), {}));
  return m;
}

}  // namespace

TEST(Slip, MercuryKeepsItsTangentialVelocityAndTiedMercuryDoesNot) {
  const double time = 5e-5;
  const Vec3 v{1.0, -0.5, 0};
  std::array<double, 2> lost{};
  for (const bool slip : {true, false}) {
    const Mesh mesh = layers(slip);
    const Motion m = slide(mesh, v, time);
    double liquid_error = 0, steel_motion = 0;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      const auto u = hexahedron::point(m.displacement[n]);
      if (m.liquid[n])
        liquid_error = std::max(liquid_error, (u - time * hexahedron::point(v)).norm() / time);
      else
        steel_motion = std::max(steel_motion, u.norm() / time);
    }
    lost[slip ? 0 : 1] = liquid_error / hexahedron::point(v).norm();
    if (slip) {
      EXPECT_LT(steel_motion, 1e-10);
    } else {
      EXPECT_GT(steel_motion, 0.1);
    }
  }
  verify({.item = "Slip",
          .quantity = "tangential velocity lost along a wall",
          .reference = 0,
          .source = "none",
          .measured = lost[0],
          .tolerance = 1e-10,
          .control = "tied",
          .control_value = lost[1]});
}

TEST(Slip, NormalMotionIsCommonAndMomentumIsKept) {
  const Mesh mesh = layers(true);
  const double time = 2e-5;
  const Vec3 v{0.3, 0, -1};
  const Motion m = slide(mesh, v, time);
  for (const auto& p : mesh.slip) EXPECT_NEAR(m.displacement[std::size_t(p.steel)][2], m.displacement[std::size_t(p.mercury)][2], 1e-12 * time + 1e-15);
  // The momentum is sum m u / t for constant total momentum.
  const auto mass = masses(mesh, linear_setup(0, 0));
  Eigen::Vector3d got = Eigen::Vector3d::Zero(), start = Eigen::Vector3d::Zero();
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    got += mass[Eigen::Index(n)] * hexahedron::point(m.displacement[n]) / time;
    if (m.liquid[n]) start += mass[Eigen::Index(n)] * hexahedron::point(v);
  }
  EXPECT_LT((got - start).norm(), 1e-9 * start.norm());
}

// In a long box the mercury beside an edge between two walls moves along that edge only.
TEST(Slip, AlongAnEdgeBetweenTwoWallsOnlyTheEdgeDirectionIsFree) {
  GeometryOptions g;
  g.kind = "box";
  g.length = 0.06;
  g.width = 0.024;
  g.height = 0.02;
  g.wall = 0.004;
  g.element_size = 0.002;
  Mesh mesh = make_mesh(g);
  mesh.rear.clear();  // a free end
  // The run stops before a wave from the front wall can reach the middle.
  const double time = 3e-6;
  const Motion m = slide(mesh, {1, 0, 0}, time);
  int edges = 0;
  for (const auto& p : mesh.slip) {
    const auto& x = mesh.nodes[std::size_t(p.mercury)];
    if (p.count != 2 || x[0] < 0.03 || x[0] > 0.05) continue;
    ++edges;
    EXPECT_NEAR(m.displacement[std::size_t(p.mercury)][0], time, 1e-3 * time);
    EXPECT_LT(std::abs(m.displacement[std::size_t(p.steel)][0]), 1e-3 * time);
  }
  EXPECT_GE(edges, 8);
}
