#include "forward/solver/reentrant_edges.hpp"

#include <cmath>
#include <map>

#include "forward/mesh/hexahedron.hpp"

namespace calomel {

std::vector<std::uint8_t> reentrant_elements(const Mesh& mesh) {
  std::vector<std::uint8_t> touches(mesh.nodes.size(), 0);  // steel elements at a node
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    if (mesh.region[e] == Region::steel)
      for (const NodeId n : mesh.elements[e]) ++touches[std::size_t(n)];
  // Where elements meet regularly, an inner node has 8, one of a face 4, of an outer edge 2, of an outer corner 1.
  const auto candidate = [&](NodeId n) {
    const int t = touches[std::size_t(n)];
    return t != 1 && t != 2 && t != 4 && t != 8;
  };

  struct Around {
    double angle = 0;  ///< of the steel [rad]
    std::vector<std::int32_t> elements;
  };
  std::map<std::pair<NodeId, NodeId>, Around> edges;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    if (mesh.region[e] != Region::steel) continue;
    for (const auto& edge : hexahedron::edges) {
      const NodeId a = mesh.elements[e][std::size_t(edge[0])], b = mesh.elements[e][std::size_t(edge[1])];
      if (!candidate(a) || !candidate(b)) continue;
      // Angle between the element's two faces along the edge, from the other edges at both ends.
      const int axis = edge[0] ^ edge[1], first = axis == 1 ? 2 : 1, second = axis == 4 ? 2 : 4;
      const auto x = hexahedron::corners(mesh, e);
      const auto point = [&](int corner) { return x[std::size_t(corner)]; };
      const hexahedron::Point along = (point(edge[1]) - point(edge[0])).normalized();
      hexahedron::Point p = point(edge[0] ^ first) - point(edge[0]) + point(edge[1] ^ first) - point(edge[1]);
      hexahedron::Point q = point(edge[0] ^ second) - point(edge[0]) + point(edge[1] ^ second) - point(edge[1]);
      p -= p.dot(along) * along;
      q -= q.dot(along) * along;
      Around& around = edges[std::minmax(a, b)];
      around.angle += std::atan2(p.cross(q).norm(), p.dot(q));
      around.elements.push_back(std::int32_t(e));
    }
  }
  std::vector<std::uint8_t> out(mesh.elements.size(), 0);
  const double degree = M_PI / 180;
  for (const auto& [edge, around] : edges)
    if (std::abs(around.angle - 270 * degree) < 20 * degree)
      for (const auto e : around.elements) out[std::size_t(e)] = 1;
  return out;
}

}  // namespace calomel
