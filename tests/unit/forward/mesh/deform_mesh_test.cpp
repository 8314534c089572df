#include "forward/mesh/deform_mesh.hpp"

#include <gmock/gmock.h>

#include "forward/mesh/make_mesh.hpp"
#include "tests/unit/forward/mesh/mesh_checks.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {
GeometryOptions box() {
  GeometryOptions g;
  g.kind = "box";
  g.length = 0.06;
  g.width = 0.05;
  g.height = 0.05;
  g.wall = 0.004;
  g.element_size = 0.005;
  return g;
}
GeometryOptions jet() {
  GeometryOptions g;
  g.kind = "jet_flow";
  g.element_size = 0.01;
  g.half = true;
  return g;
}
double largest_move(const Mesh& a, const Mesh& b) {
  double m = 0;
  for (std::size_t n = 0; n < a.nodes.size(); ++n) m = std::max(m, (hexahedron::point(a.nodes[n]) - hexahedron::point(b.nodes[n])).norm());
  return m;
}
}  // namespace

TEST(DisplaceNodes, MovesPartnersTogetherAndRefusesToInvert) {
  Mesh m = make_mesh(box());
  const Mesh before = m;
  std::vector<Vec3> u;
  for (const auto& x : m.nodes) u.push_back({0.1 * x[0], 0, 0.05 * x[0]});
  displace_nodes(m, u);
  expect_sound(m, 0.9);
  EXPECT_NEAR(m.quality.mercury_volume, 1.1 * before.quality.mercury_volume, 1e-12);
  // A deformation that collapses an element is refused and leaves the mesh unchanged.
  for (std::size_t n = 0; n < u.size(); ++n) u[n] = {-2 * m.nodes[n][0], 0, 0};
  const auto nodes = m.nodes;
  EXPECT_THROW(displace_nodes(m, u), NumericsError);
  EXPECT_EQ(nodes, m.nodes);
}

TEST(Jittered, KeepsShapeAndVolumesOfABox) {
  for (const bool plane_strain : {false, true}) {
    auto g = box();
    g.plane_strain = plane_strain;
    const Mesh before = make_mesh(g);
    RandomStream a(7, 0), b(7, 0), c(7, 1);
    const Mesh m = jittered(before, 0.25, a), same = jittered(before, 0.25, b), other = jittered(before, 0.25, c);
    expect_sound(m, 0.15);
    EXPECT_EQ(m.nodes, same.nodes);
    EXPECT_NE(m.nodes, other.nodes);
    EXPECT_NEAR(m.quality.mercury_volume, before.quality.mercury_volume, 1e-10 * before.quality.mercury_volume);
    EXPECT_NEAR(m.quality.steel_volume, before.quality.steel_volume, 1e-10 * before.quality.steel_volume);
    EXPECT_NEAR(area(m, m.outer), area(before, before.outer), 1e-12);
    EXPECT_NEAR(area(m, m.wetted), area(before, before.wetted), 1e-12);
    EXPECT_GT(largest_move(m, before), 0.0005);
    EXPECT_LT(m.quality.least_scaled_jacobian, 0.99);
    if (!plane_strain) continue;
    for (const auto& x : m.nodes) EXPECT_DOUBLE_EQ(std::abs(x[1]), 0.0025);
  }
}

TEST(Jittered, LeavesCurvedSurfacesWhereTheyAre) {
  const Mesh before = make_mesh(jet());
  RandomStream random(7, 2);
  const Mesh m = jittered(before, 0.25, random);
  expect_sound(m, 0.14);
  EXPECT_NEAR(m.quality.mercury_volume, before.quality.mercury_volume, 1e-9 * before.quality.mercury_volume);
  EXPECT_NEAR(area(m, m.outer), area(before, before.outer), 1e-9);
  EXPECT_GT(largest_move(m, before), 0.0005);
}

TEST(ThinWall, TakesTheFractionFromInside) {
  for (const char* wall : {"top", "bottom", "front", "side", "rear"}) {
    auto g = box();
    g.rear = "wall";
    g.half = true;
    Mesh m = make_mesh(g);
    const Mesh before = m;
    thin_wall(m, {.wall = wall, .fraction = 0.25});
    expect_sound(m, 0.4);
    const std::string w = wall;
    const double wetted = w == "side" ? 0.052 * 0.042 : w == "front" || w == "rear" ? 0.021 * 0.042 : 0.052 * 0.021;
    EXPECT_NEAR(m.quality.mercury_volume - before.quality.mercury_volume, wetted * 0.001, 1e-12) << wall;
    EXPECT_NEAR(m.quality.steel_volume + m.quality.mercury_volume, before.quality.steel_volume + before.quality.mercury_volume, 1e-12);
    for (const auto& f : before.outer)
      for (const NodeId n : f.nodes) EXPECT_EQ(m.nodes[std::size_t(n)], before.nodes[std::size_t(n)]);
  }
}

TEST(ThinWall, KeepsToItsStretchAndItsWall) {
  Mesh m = make_mesh(box());
  const Mesh before = m;
  thin_wall(m, {.wall = "top", .fraction = 0.5, .begin = 0.02, .end = 0.04});
  double thinnest = 1;
  for (const auto& p : m.slip) {
    const auto& x = m.nodes[std::size_t(p.steel)];
    const auto& old = before.nodes[std::size_t(p.steel)];
    if (old[0] >= 0.02 && old[0] <= 0.04 && old[2] > 0.045) thinnest = std::min(thinnest, 0.05 - x[2]);
    const double half = 0.5 * 0.056 / 12;  // a node represents the wall for half an element on either side
    EXPECT_TRUE((old[0] > 0.02 - half && old[0] < 0.04 + half) || x == old);
  }
  EXPECT_NEAR(thinnest, 0.002, 1e-12);
  EXPECT_THROW(thin_wall(m, {.wall = "lid", .fraction = 0.1}), InputError);
  EXPECT_THROW(thin_wall(m, {.wall = "rear", .fraction = 0.1}), InputError);  // a non-reflecting rear has no wall
  EXPECT_THROW(thin_wall(m, {.wall = "top", .fraction = 1}), InputError);
}

TEST(ThinWall, WorksRoundTheNoseAndSparesThePlates) {
  Mesh m = make_mesh(jet());
  const Mesh before = m;
  thin_wall(m, {.wall = "front", .fraction = 0.4});
  expect_sound(m, 0.3);
  EXPECT_LT(m.quality.steel_volume, before.quality.steel_volume * 0.9999);
  EXPECT_NEAR(m.quality.steel_volume + m.quality.mercury_volume, before.quality.steel_volume + before.quality.mercury_volume, 1e-9);
}
