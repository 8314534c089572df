#include "forward/mesh/assemble_mesh.hpp"

#include <cmath>
#include <numeric>

#include "base/errors.hpp"
#include "base/median.hpp"
#include "forward/mesh/topology.hpp"

namespace calomel {
namespace {

using hexahedron::Point;

/// Steel first, then mercury, each along a Morton walk.
void sort_elements(BareGrid& grid) {
  std::vector<Vec3> centres(grid.elements.size());
  for (std::size_t e = 0; e < centres.size(); ++e) {
    Point c = Point::Zero();
    for (const NodeId n : grid.elements[e]) c += hexahedron::point(grid.nodes[std::size_t(n)]);
    centres[e] = hexahedron::vec3(c / 8);
  }
  auto order = morton_order(centres);
  std::stable_partition(order.begin(), order.end(), [&](std::int32_t e) { return grid.region[std::size_t(e)] == Region::steel; });
  std::vector<std::array<NodeId, 8>> elements(order.size());
  std::vector<Region> region(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) elements[i] = grid.elements[std::size_t(order[i])], region[i] = grid.region[std::size_t(order[i])];
  grid.elements = std::move(elements);
  grid.region = std::move(region);
}

/// New number of each node in order of first touch by an element.
std::vector<NodeId> first_touch(const std::vector<std::array<NodeId, 8>>& elements, std::size_t nodes) {
  std::vector<NodeId> number(nodes, -1);
  NodeId next = 0;
  for (const auto& e : elements)
    for (const NodeId n : e)
      if (number[std::size_t(n)] < 0) number[std::size_t(n)] = next++;
  expect(std::size_t(next) == nodes, "every node belongs to an element");
  return number;
}

void renumber_nodes(Mesh& mesh, std::vector<std::pair<NodeId, NodeId>>& pairs) {
  const auto number = first_touch(mesh.elements, mesh.nodes.size());
  std::vector<Vec3> nodes(mesh.nodes.size());
  for (std::size_t n = 0; n < nodes.size(); ++n) nodes[std::size_t(number[n])] = mesh.nodes[n];
  mesh.nodes = std::move(nodes);
  for (auto& e : mesh.elements)
    for (auto& n : e) n = number[std::size_t(n)];
  for (auto& [steel, mercury] : pairs) {
    steel = number[std::size_t(steel)];
    mercury = number[std::size_t(mercury)];
  }
}

/// Gives mercury its own node wherever it shares one with steel: (steel, mercury) pairs.
std::vector<std::pair<NodeId, NodeId>> split_wetted_nodes(Mesh& mesh) {
  std::vector<std::uint8_t> touches(mesh.nodes.size(), 0);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    for (const NodeId n : mesh.elements[e]) touches[std::size_t(n)] |= mesh.region[e] == Region::steel ? 1 : 2;
  std::vector<std::pair<NodeId, NodeId>> pairs;
  std::vector<NodeId> own(mesh.nodes.size(), -1);
  const std::size_t before = mesh.nodes.size();
  for (std::size_t n = 0; n < before; ++n)
    if (touches[n] == 3) {
      own[n] = NodeId(mesh.nodes.size());
      pairs.emplace_back(NodeId(n), own[n]);
      mesh.nodes.push_back(Vec3(mesh.nodes[n]));
    }
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    if (mesh.region[e] == Region::mercury)
      for (auto& n : mesh.elements[e])
        if (own[std::size_t(n)] >= 0) n = own[std::size_t(n)];
  return pairs;
}

}  // namespace

int distinct_normals(std::span<const Point> areas, std::uint8_t fixed, std::array<Vec3, 3>& normals) {
  const double merge = std::cos(40 * M_PI / 180);
  std::array<Point, 8> sums;
  std::size_t clusters = 0;
  for (const Point& area : areas) {
    Point a = area;
    for (int k = 0; k < 3; ++k)
      if (fixed >> k & 1) a[k] = 0;
    if (a.norm() < 1e-3 * area.norm()) continue;
    std::size_t best = clusters;
    double closest = merge;
    for (std::size_t c = 0; c < clusters; ++c)
      if (const double cosine = std::abs(sums[c].dot(a)) / (sums[c].norm() * a.norm()); cosine >= closest) closest = cosine, best = c;
    if (best < clusters)
      sums[best] += sums[best].dot(a) < 0 ? Point(-a) : a;
    else if (clusters < sums.size())
      sums[clusters++] = a;
  }
  // Gram-Schmidt; what is left of a direction below 0.05 adds nothing to the span.
  int count = 0;
  for (std::size_t c = 0; c < clusters && count < 3; ++c) {
    Point n = sums[c].normalized();
    for (int k = 0; k < count; ++k) n -= n.dot(hexahedron::point(normals[std::size_t(k)])) * hexahedron::point(normals[std::size_t(k)]);
    if (n.norm() < 0.05) continue;
    normals[std::size_t(count++)] = hexahedron::vec3(n.normalized());
  }
  for (int k = count; k < 3; ++k) normals[std::size_t(k)] = {0, 0, 0};
  return count;
}

void update_slip_normals(Mesh& mesh) {
  if (mesh.slip.empty()) return;
  std::vector<std::int32_t> pair_of(mesh.nodes.size(), -1);
  for (std::size_t p = 0; p < mesh.slip.size(); ++p) pair_of[std::size_t(mesh.slip[p].mercury)] = std::int32_t(p);
  std::vector<std::int32_t> begin(mesh.slip.size() + 1, 0);
  for (const auto& f : mesh.wetted)
    for (const NodeId n : f.nodes) {
      expect(pair_of[std::size_t(n)] >= 0, "every node of a wetted face is paired");
      ++begin[std::size_t(pair_of[std::size_t(n)]) + 1];
    }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Point> areas(4 * mesh.wetted.size());
  auto next = begin;
  for (const auto& f : mesh.wetted) {
    const Point a = hexahedron::area_vector(mesh, f);
    for (const NodeId n : f.nodes) areas[std::size_t(next[std::size_t(pair_of[std::size_t(n)])]++)] = a;
  }
  for (std::size_t p = 0; p < mesh.slip.size(); ++p) {
    auto& pair = mesh.slip[p];
    expect(begin[p] < begin[p + 1], "a node shared by steel and mercury lies on a wetted face");
    const std::span<const Point> own(areas.data() + begin[p], std::size_t(begin[p + 1] - begin[p]));
    pair.count = distinct_normals(own, mesh.fixed[std::size_t(pair.mercury)], pair.normals);
  }
}

MeshQuality measure_quality(const Mesh& mesh) {
  MeshQuality q;
  q.least_wall_elements = mesh.quality.least_wall_elements;
  double shortest = 1e300, aspect = 1;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const auto x = hexahedron::corners(mesh, e);
    q.least_scaled_jacobian = std::min(q.least_scaled_jacobian, hexahedron::scaled_jacobian(x));
    const auto edges = hexahedron::squared_edges(x);
    const auto [low, high] = std::minmax_element(edges.begin(), edges.end());
    shortest = std::min(shortest, *low);
    aspect = std::max(aspect, *high / *low);
    (mesh.region[e] == Region::steel ? q.steel_volume : q.mercury_volume) += hexahedron::volume(x);
  }
  q.shortest_edge = std::sqrt(shortest);
  q.greatest_aspect_ratio = std::sqrt(aspect);
  return q;
}

double shortest_edge(const Mesh& mesh, std::size_t e) {
  const auto x = hexahedron::corners(mesh, e);
  double least = 1e300;
  for (const auto& edge : hexahedron::edges) {
    const Point d = x[std::size_t(edge[1])] - x[std::size_t(edge[0])];
    if (mesh.plane_strain && std::abs(d.y()) > 0.7 * d.norm()) continue;
    least = std::min(least, d.squaredNorm());
  }
  return std::sqrt(least);
}

double median_liquid_edge(const Mesh& mesh) {
  std::vector<double> shortest;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    if (mesh.region[e] == Region::mercury) shortest.push_back(shortest_edge(mesh, e));
  return shortest.empty() ? 0 : upper_median(std::move(shortest));
}

Mesh assemble_mesh(BareGrid grid, const AssemblyOptions& options) {
  sort_elements(grid);
  Mesh mesh;
  mesh.nodes = std::move(grid.nodes);
  mesh.elements = std::move(grid.elements);
  mesh.region = std::move(grid.region);
  mesh.plane_strain = options.plane_strain;
  mesh.mirrors = options.mirrors;
  mesh.quality.least_wall_elements = options.least_wall_elements;

  // Boundary and wetted faces, while steel and mercury are still connected.
  struct Boundary {
    FaceId face;
    BoundaryKind kind;
  };
  std::vector<Boundary> boundary;
  std::vector<FaceId> wetted;
  {
    const auto match = matching_faces(mesh.elements, mesh.nodes.size());
    for (FaceId f = 0; f < FaceId(match.size()); ++f) {
      const bool liquid = mesh.region[std::size_t(element_of(f))] == Region::mercury;
      if (match[std::size_t(f)] != no_face) {
        if (liquid && mesh.region[std::size_t(element_of(match[std::size_t(f)]))] == Region::steel) wetted.push_back(f);
        continue;
      }
      const Face face{.nodes = face_nodes(mesh.elements, f), .element = element_of(f)};
      const auto kind = options.boundary_of_nodes ? options.boundary_of_nodes(face.nodes)
                                                  : options.boundary(hexahedron::centre(mesh, face), hexahedron::area_vector(mesh, face).normalized());
      expect(!liquid || (kind != BoundaryKind::outer && kind != BoundaryKind::loaded), "mercury is enclosed by steel, symmetry planes and the rear end");
      boundary.push_back({f, kind});
    }
  }
  std::vector<std::pair<NodeId, NodeId>> pairs;
  if (options.slip) pairs = split_wetted_nodes(mesh);
  renumber_nodes(mesh, pairs);

  mesh.fixed.assign(mesh.nodes.size(), 0);
  for (const auto& [f, kind] : boundary) {
    const Face face{.nodes = face_nodes(mesh.elements, f), .element = element_of(f)};
    if (kind == BoundaryKind::symmetry_x || kind == BoundaryKind::symmetry_y || kind == BoundaryKind::symmetry_z)
      for (const NodeId n : face.nodes) mesh.fixed[std::size_t(n)] |= kind == BoundaryKind::symmetry_x ? 1 : kind == BoundaryKind::symmetry_y ? 2 : 4;
    else if (kind == BoundaryKind::outer)
      mesh.outer.push_back(face);
    else if (kind == BoundaryKind::loaded)
      mesh.loaded.push_back(face);
    else if (kind == BoundaryKind::rear && mesh.region[std::size_t(face.element)] == Region::mercury)
      mesh.rear.push_back(face);
  }
  for (const FaceId f : wetted) mesh.wetted.push_back({.nodes = face_nodes(mesh.elements, f), .element = element_of(f)});
  for (const auto& [steel, mercury] : pairs) mesh.slip.push_back({.steel = steel, .mercury = mercury, .count = 0, .normals = {}});
  update_slip_normals(mesh);
  mesh.quality = measure_quality(mesh);
  expect(mesh.quality.least_scaled_jacobian > 0, "every element has positive Jacobians");
  mesh.liquid_element_size = median_liquid_edge(mesh);
  return mesh;
}

}  // namespace calomel
