#include "apps/report/data/surface.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;

TEST(ReportSurface, ThinningKeepsTheBoxAndItsLimit) {
  const Vec3 low{0, -0.05, 0}, high{0.211, 0.05, 0.062};
  const ReportSurface fine = box(low, high, 300);
  ASSERT_GT(fine.quads.size(), 50000u);
  const ReportSurface thin = thinned(fine, 5000);
  EXPECT_LE(thin.quads.size(), 5000u);
  EXPECT_GT(thin.quads.size(), 1000u);
  for (int axis = 0; axis < 3; ++axis) {
    double least = 1, greatest = -1;
    for (const auto& v : thin.vertices) {
      least = std::min(least, v[axis]);
      greatest = std::max(greatest, v[axis]);
    }
    EXPECT_EQ(least, low[axis]);
    EXPECT_EQ(greatest, high[axis]);
  }
  // The surface is closed to within a cell, so its area is that of the box.
  double area = 0;
  for (const auto& q : thin.quads) {
    Vec3 d1, d2;
    for (int i = 0; i < 3; ++i) {
      d1[i] = thin.vertices[q[2]][i] - thin.vertices[q[0]][i];
      d2[i] = thin.vertices[q[3]][i] - thin.vertices[q[1]][i];
    }
    area += 0.5 * std::hypot(d1[1] * d2[2] - d1[2] * d2[1], d1[2] * d2[0] - d1[0] * d2[2], d1[0] * d2[1] - d1[1] * d2[0]);
  }
  const double exact = 2 * (0.211 * 0.1 + 0.211 * 0.062 + 0.1 * 0.062);
  EXPECT_NEAR(area, exact, 0.03 * exact);
  EXPECT_EQ(thinned(fine, fine.quads.size()).quads.size(), fine.quads.size());
}

TEST(ReportSurface, TheMeshGivesOnlyTheNodesOfItsFaces) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.nodes.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2)});
  mesh.outer.push_back({{4, 5, 7, 6}, 0});
  const ReportSurface s = report_surface(mesh, mesh.outer);
  ASSERT_EQ(s.vertices.size(), 4u);
  ASSERT_EQ(s.quads.size(), 1u);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(s.vertices[std::size_t(s.quads[0][i])], mesh.nodes[std::size_t(mesh.outer[0].nodes[i])]);
}
