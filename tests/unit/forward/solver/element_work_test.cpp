#include "tests/bench/element_work.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "forward/mesh/make_mesh.hpp"

namespace calomel {
namespace {

/// Operations counted by hand from the formulas of kernel_elements.hpp.
TEST(ElementWork, IsTheCountOfTheFormulas) {
  // Butterflies of eight values take 8 + 8 + 7 operations forwards and 6 + 8 + 8 back, and then 24 sums at the nodes.
  // A product with n terms takes n multiplications and n - 1 additions.
  const int to_modes = 3 * 23, to_corners = 3 * 22 + 24;
  const int pressure = 2 + 2 + 1 + 1;                                         // trace, p0 - K e, times volume, p0 x share
  const int stress = 6 + (2 + 1) + 3 * 2 + 3 + 9;                             // 2 e, lambda tr e, diagonal, shears, times volume
  const int bending = 9 * (9 + 8) + 3 * (3 + 2);                              // 9 x 9 and 3 x 3
  const int projected = 12 * (3 + 2 + 1), taken_off = 12;                     // q - X.grad, and the hourglass forces themselves
  const int share_steel = 9 * 4 * 2, share_liquid = 3 * 4 * 2 + 6 * (4 + 3);  // X.force in the mean stress; only the liquid's diagonal has a pressure to add to

  const ElementWork liquid = element_work(true, Form::parallelepiped);
  EXPECT_EQ(liquid.to_modes, to_modes);
  EXPECT_EQ(liquid.to_corners, to_corners);
  EXPECT_EQ(liquid.gradients, 9 * (3 + 2));
  EXPECT_EQ(liquid.law, pressure);
  EXPECT_EQ(liquid.hourglass, 1 + 12);
  EXPECT_EQ(liquid.spread, 9);

  const ElementWork general_liquid = element_work(true, Form::general);
  EXPECT_EQ(general_liquid.gradients, 9 * (7 + 6));
  EXPECT_EQ(general_liquid.law, pressure);
  EXPECT_EQ(general_liquid.hourglass, 1 + projected + 12 + share_liquid + taken_off);
  EXPECT_EQ(general_liquid.spread, 21 * (3 + 2));

  const ElementWork steel = element_work(false, Form::parallelepiped);
  EXPECT_EQ(steel.law, stress);
  EXPECT_EQ(steel.hourglass, bending);
  EXPECT_EQ(steel.spread, 9 * (3 + 2));
  const ElementWork general_steel = element_work(false, Form::general);
  EXPECT_EQ(general_steel.hourglass, bending + projected + share_steel + taken_off);

  EXPECT_EQ(liquid.total(), 232);
  EXPECT_EQ(general_liquid.total(), 550);
  EXPECT_EQ(steel.total(), 444);
  EXPECT_EQ(general_steel.total(), 732);
}

TEST(ElementWork, OfAMeshIsTheMeanOfItsElementsAndTheirNodes) {
  GeometryOptions g;
  g.kind = "box";
  g.length = 0.04;
  g.width = 0.04;
  g.height = 0.03;
  g.wall = 0.005;
  g.plane_strain = true;
  g.element_size = 0.0025;
  const Mesh mesh = make_mesh(g);
  const double steel = double(std::count(mesh.region.begin(), mesh.region.end(), Region::steel)) / double(mesh.region.size());
  ASSERT_GT(steel, 0.1);
  ASSERT_LT(steel, 0.9);
  const double nodes = double(mesh.nodes.size()) / double(mesh.elements.size());
  const MeshWork one = mesh_work(mesh, 8, false), eight = mesh_work(mesh, 8, true);  // every element of this box is a parallelepiped
  EXPECT_NEAR(one.flops, steel * 444 + (1 - steel) * 232 + 19 * nodes, 1e-9);
  EXPECT_NEAR(one.bytes, 8 * (steel * 61 + (1 - steel) * 11) + 16 + nodes * 8 * 16, 1e-9);
  EXPECT_EQ(eight.flops, one.flops);
  EXPECT_NEAR(eight.bytes, steel * 61 + (1 - steel) * 11 + 2 + nodes * 8 * 12, 1e-9);
}

}  // namespace
}  // namespace calomel
