#include "forward/solver/layout.hpp"

#include <gmock/gmock.h>

#include <set>

#include "forward/mesh/hexahedron.hpp"
#include "forward/mesh/make_mesh.hpp"

using namespace calomel;

namespace {
Mesh box() {
  GeometryOptions g;
  g.kind = "box";
  g.length = 0.05;
  g.width = 0.04;
  g.height = 0.03;
  g.wall = 0.004;
  g.half = true;
  g.element_size = 0.002;
  return make_mesh(g);
}
}  // namespace

TEST(Layout, EveryElementNodeAndRuleHasItsPlaceOnce) {
  const Mesh mesh = box();
  const Layout layout = make_layout(mesh, std::vector<std::uint8_t>(mesh.elements.size(), 1), 256);
  std::set<std::int32_t> elements, solver_ids(layout.to_solver.begin(), layout.to_solver.end());
  for (const auto& b : layout.blocks) {
    EXPECT_LE(b.elements.size(), 256u);
    std::int32_t covered = 0;
    for (const auto& r : b.ranges) {
      covered += r.end - r.begin;
      for (std::int32_t n = r.begin; n < r.end; ++n) EXPECT_EQ(layout.fixed[std::size_t(n)], r.fixed);
    }
    EXPECT_EQ(covered, b.interior);
    for (std::size_t i = 0; i < b.elements.size(); ++i) {
      EXPECT_TRUE(elements.insert(b.elements[i]).second);
      EXPECT_EQ(mesh.region[std::size_t(b.elements[i])] == Region::mercury, b.liquid);
      // The local connectivity leads back to that of the mesh.
      for (std::size_t k = 0; k < 8; ++k) {
        const int local = b.connectivity[i * 8 + k];
        const std::int32_t solver = local < b.interior ? b.first_node + local : b.shared[std::size_t(local - b.interior)];
        EXPECT_EQ(solver, layout.to_solver[std::size_t(mesh.elements[std::size_t(b.elements[i])][k])]);
      }
    }
  }
  EXPECT_EQ(elements.size(), mesh.elements.size());
  EXPECT_EQ(solver_ids.size(), mesh.nodes.size());
  EXPECT_EQ(*solver_ids.begin(), 0);
  EXPECT_EQ(*solver_ids.rbegin(), layout.nodes - 1);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) EXPECT_EQ(layout.fixed[std::size_t(layout.to_solver[n])], mesh.fixed[n]);
  // A shared node is plain, leads a rule, or is the partner in one.
  std::set<std::int32_t> shared(layout.plain.begin(), layout.plain.end());
  std::size_t pairs = 0;
  for (const auto& s : layout.special) {
    EXPECT_TRUE(shared.insert(s.node).second);
    if (s.partner < 0) continue;
    ++pairs;
    EXPECT_TRUE(shared.insert(s.partner).second);
  }
  EXPECT_EQ(pairs, mesh.slip.size());
  EXPECT_EQ(shared.size(), std::size_t(layout.nodes - layout.first_shared));
  EXPECT_EQ(*shared.begin(), layout.first_shared);
}

TEST(Layout, SharesOfARearFaceAddUpToItsArea) {
  const Mesh mesh = box();
  Vec3 sum{};
  for (const auto& n : boundary_nodes(mesh, mesh.rear))
    for (std::size_t c = 0; c < 3; ++c) sum[c] += n.area[c];
  EXPECT_NEAR(sum[0], 0.016 * 0.022, 1e-12);
  EXPECT_NEAR(sum[1], 0, 1e-15);
  EXPECT_NEAR(sum[2], 0, 1e-15);
}
