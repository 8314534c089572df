#include "forward/solver/reentrant_edges.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <bit>

#include "forward/mesh/hexahedron.hpp"
#include "forward/mesh/make_mesh.hpp"

using namespace calomel;

namespace {

std::vector<hexahedron::Point> centres(const Mesh& mesh) {
  const auto marked = reentrant_elements(mesh);
  std::vector<hexahedron::Point> out;
  for (std::size_t e = 0; e < marked.size(); ++e) {
    if (!marked[e]) continue;
    EXPECT_EQ(mesh.region[e], Region::steel);
    hexahedron::Point c = hexahedron::Point::Zero();
    for (const auto& x : hexahedron::corners(mesh, e)) c += x / 8;
    out.push_back(c);
  }
  return out;
}

GeometryOptions box(bool plane_strain) {
  GeometryOptions g;
  g.kind = "box";
  g.length = 0.03;
  g.width = 0.024;
  g.height = 0.02;
  g.wall = 0.004;
  g.element_size = 0.002;
  g.plane_strain = plane_strain;
  return g;
}

}  // namespace

TEST(ReentrantEdges, OfAPlaneStrainBoxAreItsTwoInnerCornersWithThreeElementsEach) {
  for (const char* wetted : {"slip", "tied"}) {
    auto g = box(true);
    g.wetted = wetted;
    const auto found = centres(make_mesh(g));
    EXPECT_EQ(found.size(), 6u) << wetted;
    for (const auto& c : found) {
      EXPECT_NEAR(std::abs(c.x() - 0.004), 0.001, 1e-9);
      EXPECT_NEAR(std::min(std::abs(c.z() - 0.004), std::abs(c.z() - 0.016)), 0.001, 1e-9);
    }
  }
}

// Every element of the solid box within one layer of two wetted planes, but outside the mercury.
TEST(ReentrantEdges, OfASolidBoxAreTheEdgesBetweenItsWettedFaces) {
  const Mesh mesh = make_mesh(box(false));
  const auto found = centres(mesh);
  std::size_t expected = 0;
  const auto marked = reentrant_elements(mesh);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    if (mesh.region[e] != Region::steel) continue;
    bool touches = false;
    for (const auto& edge : hexahedron::edges) {
      const auto &a = mesh.nodes[std::size_t(mesh.elements[e][std::size_t(edge[0])])], &b = mesh.nodes[std::size_t(mesh.elements[e][std::size_t(edge[1])])];
      const auto planes = [](const Vec3& x) {  // bits of the wetted planes that contain x, and whether x is on the surface of the mercury
        const double eps = 1e-9;
        if (x[0] < 0.004 - eps || std::abs(x[1]) > 0.008 + eps || x[2] < 0.004 - eps || x[2] > 0.016 + eps) return 0;
        return (std::abs(x[0] - 0.004) < eps ? 1 : 0) | (std::abs(std::abs(x[1]) - 0.008) < eps ? 2 : 0) |
               (std::abs(x[2] - 0.004) < eps || std::abs(x[2] - 0.016) < eps ? 4 : 0);
      };
      touches = touches || std::popcount(unsigned(planes(a) & planes(b))) >= 2;
    }
    expected += touches;
    EXPECT_EQ(touches, marked[e] != 0) << e;
  }
  EXPECT_EQ(found.size(), expected);
  EXPECT_GT(expected, 100u);
}

TEST(ReentrantEdges, ABarHasNone) {
  GeometryOptions g;
  g.kind = "bar";
  g.radius = 0.01;
  g.length = 0.05;
  g.quarter = false;
  EXPECT_TRUE(centres(make_mesh(g)).empty());
}

// The rounded nose has no re-entrant edge. A jet-flow target has the edges between its side wall and the others.
TEST(ReentrantEdges, OfAJetFlowTargetLieAtItsSideWall) {
  GeometryOptions g;
  g.kind = "jet_flow";
  g.half = true;
  g.element_size = 0.008;
  const auto found = centres(make_mesh(g));
  EXPECT_GT(found.size(), 20u);
  double inner = 0;
  for (const auto& c : found) inner = std::max(inner, 0.2 - std::abs(c.y()));
  EXPECT_LT(inner, 0.004 + 0.008);
}
