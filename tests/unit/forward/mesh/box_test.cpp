#include <gmock/gmock.h>

#include "base/random.hpp"
#include "forward/mesh/assemble_mesh.hpp"
#include "forward/mesh/make_mesh.hpp"
#include "tests/unit/forward/mesh/mesh_checks.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

GeometryOptions box(double element_size) {
  GeometryOptions g;
  g.kind = "box";
  g.length = 0.08;
  g.width = 0.06;
  g.height = 0.05;
  g.wall = 0.003;
  g.walls.top = 0.004;
  g.element_size = element_size;
  return g;
}

std::array<int, 4> pair_counts(const Mesh& mesh) {
  std::array<int, 4> n{};
  for (const auto& p : mesh.slip) ++n[std::size_t(p.count)];
  return n;
}

}  // namespace

TEST(Hexahedron, VolumeOfAWarpedElementIsThatOfAGaussRule) {
  RandomStream random(1, 0);
  for (int trial = 0; trial < 20; ++trial) {
    hexahedron::Corners x;
    for (std::size_t a = 0; a < 8; ++a) x[a] = {(a & 1) + random.uniform(-.2, .2), (a >> 1 & 1) + random.uniform(-.2, .2), (a >> 2) + random.uniform(-.2, .2)};
    EXPECT_NEAR(hexahedron::volume(x), gauss_volume(x), 1e-13);
    EXPECT_GT(hexahedron::scaled_jacobian(x), 0);
    std::swap(x[0], x[1]);
    EXPECT_LT(hexahedron::scaled_jacobian(x), 0);
  }
}

TEST(Box, VolumesAndAreasAreThoseOfTheDrawing) {
  for (const double h : {0.006, 0.0025}) {
    const Mesh m = make_mesh(box(h));
    expect_sound(m, 1 - 1e-9);
    const double mercury = (0.08 - 0.003) * (0.06 - 0.006) * (0.05 - 0.007);
    EXPECT_NEAR(m.quality.mercury_volume, mercury, 1e-9 * mercury);
    EXPECT_NEAR(m.quality.steel_volume, 0.08 * 0.06 * 0.05 - mercury, 1e-9 * mercury);
    EXPECT_NEAR(area(m, m.outer), 0.06 * 0.05 + 2 * 0.08 * (0.06 + 0.05), 1e-12);
    EXPECT_NEAR(area(m, m.wetted), 0.054 * 0.043 + 2 * 0.077 * (0.054 + 0.043), 1e-12);
    EXPECT_NEAR(area(m, m.rear), 0.054 * 0.043, 1e-12);
    // The wetted and rear faces close the mercury; the outer faces and the rear close the whole body.
    EXPECT_LT((area_sum(m, m.wetted) + area_sum(m, m.rear)).norm(), 1e-14);
    EXPECT_LT((area_sum(m, m.outer) + hexahedron::Point(0.06 * 0.05, 0, 0)).norm(), 1e-14);
    EXPECT_EQ(m.quality.least_wall_elements, 2);
  }
}

TEST(Box, ElementSizeIsAnUpperBoundAndWallsHaveTwoElements) {
  const Mesh m = make_mesh(box(0.004));
  for (std::size_t e = 0; e < m.elements.size(); ++e)
    for (const double s : hexahedron::squared_edges(hexahedron::corners(m, e))) EXPECT_LE(s, 0.004 * 0.004 * (1 + 1e-9));
  EXPECT_NEAR(m.quality.shortest_edge, 0.0015, 1e-12);
  auto g = box(0.004);
  g.wall_elements = 3;
  EXPECT_NEAR(make_mesh(g).quality.shortest_edge, 0.001, 1e-12);
  EXPECT_EQ(make_mesh(g).quality.least_wall_elements, 3);
  // The shortest edges of the mercury are 43 mm in 11 elements.
  EXPECT_NEAR(m.liquid_element_size, 0.077 / 20, 1e-9);
}

TEST(Box, ARearWallClosesTheVessel) {
  auto g = box(0.004);
  g.rear = "wall";
  const Mesh m = make_mesh(g);
  expect_sound(m, 1 - 1e-9);
  EXPECT_TRUE(m.rear.empty());
  EXPECT_LT(area_sum(m, m.outer).norm(), 1e-14);
  EXPECT_LT(area_sum(m, m.wetted).norm(), 1e-14);
  EXPECT_EQ(pair_counts(m)[3], 8);
}

TEST(Box, SlipDirectionsAreOneOnFacesTwoOnEdgesThreeInCorners) {
  const Mesh m = make_mesh(box(0.005));
  const auto n = pair_counts(m);
  // The mercury has 16 x 11 x 9 elements (x, y, z). It is open at the rear, so it has 4 corners, 4 edges along x and 4 edges about the front.
  EXPECT_EQ(n[3], 4);
  EXPECT_EQ(n[2], 4 * 16 + 2 * 10 + 2 * 8);
  EXPECT_EQ(n[1], 10 * 8 + 2 * 16 * 10 + 2 * 16 * 8);
  for (const auto& p : m.slip) {
    if (p.count != 1) continue;
    // The normal points out of the mercury, away from the middle of the box.
    const auto x = hexahedron::point(m.nodes[std::size_t(p.mercury)]);
    const auto normal = hexahedron::point(p.normals[0]);
    if (std::abs(normal.x()) > 0.9)
      EXPECT_LT(normal.x(), 0);
    else
      EXPECT_GT(normal.dot(x - hexahedron::Point(0.04, 0, 0.025)), 0);
  }
}

TEST(Box, TiedFacesShareTheirNodes) {
  auto g = box(0.005);
  const Mesh slip = make_mesh(g);
  g.wetted = "tied";
  const Mesh tied = make_mesh(g);
  EXPECT_TRUE(tied.slip.empty());
  EXPECT_EQ(tied.nodes.size() + slip.slip.size(), slip.nodes.size());
  EXPECT_EQ(tied.wetted.size(), slip.wetted.size());
}

TEST(Box, HalfHasHalfTheVolumeAndASymmetryPlane) {
  auto g = box(0.004);
  const Mesh full = make_mesh(g);
  g.half = true;
  const Mesh half = make_mesh(g);
  expect_sound(half, 1 - 1e-9);
  EXPECT_EQ(half.mirrors.size(), 1u);
  EXPECT_NEAR(2 * half.quality.mercury_volume, full.quality.mercury_volume, 1e-12);
  EXPECT_NEAR(2 * half.quality.steel_volume, full.quality.steel_volume, 1e-12);
  EXPECT_NEAR(2 * area(half, half.outer), area(full, full.outer), 1e-12);
  EXPECT_NEAR(2 * area(half, half.wetted), area(full, full.wetted), 1e-12);
  for (std::size_t n = 0; n < half.nodes.size(); ++n) {
    EXPECT_GE(half.nodes[n][1], 0);
    EXPECT_EQ(half.fixed[n], half.nodes[n][1] == 0 ? 2 : 0);
  }
}

TEST(Box, PlaneStrainIsOneElementThickWithBothFacesSymmetric) {
  auto g = box(0.002);
  g.plane_strain = true;
  const Mesh m = make_mesh(g);
  expect_sound(m, 1 - 1e-9);
  EXPECT_TRUE(m.plane_strain);
  for (std::size_t n = 0; n < m.nodes.size(); ++n) {
    EXPECT_EQ(m.fixed[n], 2);
    EXPECT_DOUBLE_EQ(std::abs(m.nodes[n][1]), 0.001);
  }
  EXPECT_NEAR(m.quality.mercury_volume, 0.077 * 0.043 * 0.002, 1e-12);
  EXPECT_EQ(pair_counts(m)[2], 2 * 2);  // the two edges of the front wall, a node on either side
  EXPECT_EQ(pair_counts(m)[3], 0);
  EXPECT_NEAR(area(m, m.outer), 0.002 * (0.05 + 2 * 0.08), 1e-12);
}

TEST(DistinctNormals, MergesWithinFortyDegreesAndAcrossThinSheets) {
  using hexahedron::Point;
  std::array<Vec3, 3> n;
  const double a = 15 * M_PI / 180;
  const std::vector<Point> bent{{std::sin(a), 0, std::cos(a)}, {-std::sin(a), 0, std::cos(a)}};
  EXPECT_EQ(distinct_normals(bent, 0, n), 1);
  EXPECT_NEAR(n[0][2], 1, 1e-12);
  const std::vector<Point> sheet{{0, 0, 1}, {0, 0, -2}};
  EXPECT_EQ(distinct_normals(sheet, 0, n), 1);
  const std::vector<Point> roof{{1, 0, 1}, {-1, 0, 1}};
  EXPECT_EQ(distinct_normals(roof, 0, n), 2);
  EXPECT_EQ(distinct_normals(roof, 1, n), 1);  // x is fixed, and both nodes leave the plane in z
  EXPECT_NEAR(n[0][2], 1, 1e-12);
}
