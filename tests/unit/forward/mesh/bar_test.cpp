#include <numbers>

#include "forward/mesh/make_mesh.hpp"
#include "tests/unit/forward/mesh/mesh_checks.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {
GeometryOptions bar(bool quarter) {
  GeometryOptions g;
  g.kind = "bar";
  g.length = 0.1;
  g.radius = 0.01;
  g.quarter = quarter;
  return g;
}
}  // namespace

TEST(Bar, HasTheVolumeOfARoundBarAndGoodElements) {
  const double volume = std::numbers::pi * 0.01 * 0.01 * 0.1;
  for (const bool quarter : {true, false})
    for (const double h : {0.006, 0.0025, 0.001}) {
      auto g = bar(quarter);
      g.element_size = h;
      const Mesh m = make_mesh(g);
      expect_sound(m, 0.55);
      EXPECT_NEAR(m.quality.steel_volume, quarter ? volume / 4 : volume, 1e-9 * volume);
      EXPECT_EQ(double(m.elements.size()), g.estimated_elements());
      EXPECT_NEAR(area_sum(m, m.loaded).x(), -volume / 0.1 / (quarter ? 4 : 1), 1e-12);
      EXPECT_TRUE(m.slip.empty());
      EXPECT_EQ(m.quality.least_wall_elements, 0);
      for (const auto& f : m.outer) {
        const auto c = hexahedron::centre(m, f);
        EXPECT_NEAR(std::hypot(c.y(), c.z()), 0.01, 5e-4);
      }
      EXPECT_TRUE(quarter || area_sum(m, m.outer).norm() < 1e-15);
    }
}

TEST(Bar, AQuarterIsFixedOnItsTwoPlanes) {
  const Mesh m = make_mesh(bar(true));
  EXPECT_EQ(m.mirrors.size(), 2u);
  for (std::size_t n = 0; n < m.nodes.size(); ++n) EXPECT_EQ(m.fixed[n], (m.nodes[n][1] == 0 ? 2 : 0) | (m.nodes[n][2] == 0 ? 4 : 0));
  const Mesh full = make_mesh(bar(false));
  EXPECT_TRUE(full.mirrors.empty());
  for (const auto f : full.fixed) EXPECT_EQ(f, 0);
}
