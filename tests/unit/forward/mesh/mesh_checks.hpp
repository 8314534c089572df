#pragma once
/// Checks that hold for every mesh, whatever its shape.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "forward/mesh/hexahedron.hpp"
#include "forward/mesh/topology.hpp"

namespace calomel::testing {

inline double area(const Mesh& mesh, const std::vector<Face>& faces) {
  double sum = 0;
  for (const auto& f : faces) sum += hexahedron::area_vector(mesh, f).norm();
  return sum;
}
inline hexahedron::Point area_sum(const Mesh& mesh, const std::vector<Face>& faces) {
  hexahedron::Point sum = hexahedron::Point::Zero();
  for (const auto& f : faces) sum += hexahedron::area_vector(mesh, f);
  return sum;
}
/// Volume of an element by a 2 x 2 x 2 Gauss rule, which is exact for trilinear hexahedra and independent of hexahedron::volume.
inline double gauss_volume(const hexahedron::Corners& x) {
  double v = 0;
  const double g = 1 / std::sqrt(3.0);
  for (int p = 0; p < 8; ++p) {
    const double xi[3] = {p & 1 ? g : -g, p & 2 ? g : -g, p & 4 ? g : -g};
    Eigen::Matrix3d J = Eigen::Matrix3d::Zero();
    for (std::size_t a = 0; a < 8; ++a) {
      const double s[3] = {a & 1 ? 1. : -1., a & 2 ? 1. : -1., a & 4 ? 1. : -1.};
      for (int k = 0; k < 3; ++k) J.row(k) += s[k] / 8 * (1 + s[(k + 1) % 3] * xi[(k + 1) % 3]) * (1 + s[(k + 2) % 3] * xi[(k + 2) % 3]) * x[a].transpose();
    }
    v += J.determinant();
  }
  return v;
}

/// Checks everything that a solver relies on; `least_quality` is a lower bound on the scaled Jacobian.
inline void expect_sound(const Mesh& mesh, double least_quality) {
  ASSERT_EQ(mesh.region.size(), mesh.elements.size());
  ASSERT_EQ(mesh.fixed.size(), mesh.nodes.size());
  double steel = 0, mercury = 0, worst = 1;
  std::vector<int> used(mesh.nodes.size(), 0);  // bit 0 steel, bit 1 mercury
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const auto x = hexahedron::corners(mesh, e);
    (mesh.region[e] == Region::steel ? steel : mercury) += gauss_volume(x);
    worst = std::min(worst, hexahedron::scaled_jacobian(x));
    for (const NodeId n : mesh.elements[e]) used[std::size_t(n)] |= mesh.region[e] == Region::steel ? 1 : 2;
  }
  EXPECT_GT(worst, least_quality);
  EXPECT_DOUBLE_EQ(worst, mesh.quality.least_scaled_jacobian);
  EXPECT_NEAR(mesh.quality.steel_volume, steel, 1e-9 * (steel + mercury));
  EXPECT_NEAR(mesh.quality.mercury_volume, mercury, 1e-9 * (steel + mercury));
  std::map<int, std::size_t> count;
  for (const int u : used) ++count[u];
  EXPECT_EQ(count[0], 0u) << "nodes without element";

  // Every node of the steel has at most one partner in the mercury and vice versa. Partners coincide; normals are orthonormal and not fixed.
  std::set<NodeId> steels, mercuries;
  for (const auto& p : mesh.slip) {
    EXPECT_TRUE(steels.insert(p.steel).second);
    EXPECT_TRUE(mercuries.insert(p.mercury).second);
    EXPECT_EQ(used[std::size_t(p.steel)], 1);
    EXPECT_EQ(used[std::size_t(p.mercury)], 2);
    EXPECT_EQ(mesh.nodes[std::size_t(p.steel)], mesh.nodes[std::size_t(p.mercury)]);
    EXPECT_EQ(mesh.fixed[std::size_t(p.steel)], mesh.fixed[std::size_t(p.mercury)]);
    ASSERT_GE(p.count, 1);
    ASSERT_LE(p.count, 3);
    for (int i = 0; i < p.count; ++i) {
      const auto n = hexahedron::point(p.normals[std::size_t(i)]);
      EXPECT_NEAR(n.norm(), 1, 1e-12);
      for (int j = 0; j < i; ++j) EXPECT_NEAR(n.dot(hexahedron::point(p.normals[std::size_t(j)])), 0, 1e-12);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR((mesh.fixed[std::size_t(p.mercury)] >> k & 1) * n[k], 0, 1e-12);
    }
  }
  EXPECT_TRUE(mesh.slip.empty() || count[3] == 0) << "nodes shared by steel and mercury";

  // The nodes of a face belong to its element, the normal points out of it, and every wetted node has a partner.
  for (const auto* list : {&mesh.outer, &mesh.wetted, &mesh.rear, &mesh.loaded})
    for (const auto& f : *list) {
      const auto& e = mesh.elements[std::size_t(f.element)];
      hexahedron::Point middle = hexahedron::Point::Zero();
      for (const NodeId n : e) middle += hexahedron::point(mesh.nodes[std::size_t(n)]) / 8;
      for (const NodeId n : f.nodes) EXPECT_NE(std::find(e.begin(), e.end(), n), e.end());
      EXPECT_GT(hexahedron::area_vector(mesh, f).dot(hexahedron::centre(mesh, f) - middle), 0);
      const bool liquid = mesh.region[std::size_t(f.element)] == Region::mercury;
      EXPECT_EQ(liquid, list == &mesh.wetted || list == &mesh.rear);
      if (list != &mesh.wetted || mesh.slip.empty()) continue;
      for (const NodeId n : f.nodes) EXPECT_TRUE(mercuries.contains(n));
    }

  // The boundary of the steel towards the mercury matches the wetted faces of the mercury.
  const auto tied = tied_elements(mesh);
  const auto match = matching_faces(tied, mesh.nodes.size());
  std::size_t interface = 0;
  double steel_side = 0;
  for (FaceId f = 0; f < FaceId(match.size()); ++f) {
    const auto g = match[std::size_t(f)];
    if (g == no_face || mesh.region[std::size_t(element_of(f))] != Region::steel || mesh.region[std::size_t(element_of(g))] != Region::mercury) continue;
    ++interface;
    steel_side += hexahedron::area_vector(mesh, {.nodes = face_nodes(mesh.elements, f), .element = element_of(f)}).norm();
  }
  EXPECT_EQ(interface, mesh.wetted.size());
  EXPECT_NEAR(steel_side, area(mesh, mesh.wetted), 1e-12 + 1e-9 * steel_side);

  // The mercury and the steel are connected, each by itself.
  std::array<std::size_t, 2> pieces{0, 0};
  std::vector<char> seen(tied.size(), 0);
  for (std::size_t start = 0; start < tied.size(); ++start) {
    if (seen[start]) continue;
    ++pieces[std::size_t(mesh.region[start])];
    std::vector<std::size_t> stack{start};
    seen[start] = 1;
    while (!stack.empty()) {
      const auto e = stack.back();
      stack.pop_back();
      for (std::size_t s = 0; s < 6; ++s) {
        const auto g = match[6 * e + s];
        if (g == no_face) continue;
        const auto other = std::size_t(element_of(g));
        if (seen[other] || mesh.region[other] != mesh.region[e]) continue;
        seen[other] = 1;
        stack.push_back(other);
      }
    }
  }
  EXPECT_LE(pieces[0], 1u);
  EXPECT_LE(pieces[1], 1u);
}

}  // namespace calomel::testing
