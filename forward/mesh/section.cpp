#include "forward/mesh/section.hpp"

#include <algorithm>

namespace calomel {

BareGrid extrude(const Section& section, const LayeredLine& along, const std::function<Vec3(double a, double b, double c)>& place) {
  const std::size_t points = section.points.size();
  auto quads = section.quads;
  for (auto& q : quads) {
    const auto& p = section.points;
    const Eigen::Vector2d d = p[std::size_t(q[2])] - p[std::size_t(q[0])], e = p[std::size_t(q[3])] - p[std::size_t(q[1])];
    if (d.x() * e.y() - d.y() * e.x() < 0) std::swap(q[1], q[3]);
  }
  BareGrid grid;
  grid.nodes.reserve(points * along.points.size());
  for (const double c : along.points)
    for (const auto& p : section.points) grid.nodes.push_back(place(p.x(), p.y(), c));
  grid.elements.reserve(quads.size() * along.between.size());
  grid.region.reserve(grid.elements.capacity());
  for (std::size_t k = 0; k < along.between.size(); ++k) {
    const NodeId below = NodeId(k * points), above = NodeId((k + 1) * points);
    for (std::size_t q = 0; q < quads.size(); ++q) {
      const auto& [n0, n1, n2, n3] = quads[q];
      grid.elements.push_back({below + n0, below + n1, below + n3, below + n2, above + n0, above + n1, above + n3, above + n2});
      const bool liquid = section.region[q] == Region::mercury && along.between[k] == Region::mercury;
      grid.region.push_back(liquid ? Region::mercury : Region::steel);
    }
  }
  return grid;
}

Eigen::Vector2d transfinite(const std::function<Eigen::Vector2d(int, int)>& point, int i, int j, int n, int m) {
  const double u = double(i) / n, v = double(j) / m;
  return (1 - u) * point(0, j) + u * point(n, j) + (1 - v) * point(i, 0) + v * point(i, m) - (1 - u) * (1 - v) * point(0, 0) - u * (1 - v) * point(n, 0) -
         (1 - u) * v * point(0, m) - u * v * point(n, m);
}

}  // namespace calomel
