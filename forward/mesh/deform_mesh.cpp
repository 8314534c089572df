#include "forward/mesh/deform_mesh.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/errors.hpp"
#include "base/options.hpp"
#include "forward/mesh/assemble_mesh.hpp"
#include "forward/mesh/topology.hpp"

namespace calomel {
namespace {

using hexahedron::Point;

/// Directions in which a node must not move: the span of the planes through it. 3 = it remains.
struct Held {
  int count = 0;
  std::array<Point, 3> along;
  void add(Point n) {
    if (count == 3) return;
    n.normalize();
    for (int k = 0; k < count; ++k) n -= n.dot(along[std::size_t(k)]) * along[std::size_t(k)];
    // Faces of one plane leave rounding; neighbouring facets of a curved surface leave their angle.
    if (n.norm() > 1e-6) along[std::size_t(count++)] = n.normalized();
  }
  [[nodiscard]] Point project(Point v) const {
    for (int k = 0; k < count; ++k) v -= v.dot(along[std::size_t(k)]) * along[std::size_t(k)];
    return count == 3 ? Point(Point::Zero()) : v;
  }
};

std::vector<Held> held_directions(const Mesh& mesh, const std::vector<std::array<NodeId, 8>>& tied, const std::vector<FaceId>& match) {
  std::vector<Held> held(mesh.nodes.size());
  for (FaceId f = 0; f < FaceId(match.size()); ++f) {
    const auto g = match[std::size_t(f)];
    if (g != no_face && mesh.region[std::size_t(element_of(f))] == mesh.region[std::size_t(element_of(g))]) continue;
    const Face face{.nodes = face_nodes(tied, f), .element = element_of(f)};
    const Point n = hexahedron::area_vector(mesh, face);
    for (const NodeId node : face.nodes) held[std::size_t(node)].add(n);
  }
  return held;
}

/// The node across y of each node of a plane-strain slice.
std::vector<NodeId> opposite_in_y(const Mesh& mesh, const std::vector<std::array<NodeId, 8>>& tied) {
  std::vector<NodeId> opposite(mesh.nodes.size(), -1);
  for (const auto& e : tied)
    for (const auto& edge : hexahedron::edges) {
      const NodeId a = e[std::size_t(edge[0])], b = e[std::size_t(edge[1])];
      if ((mesh.nodes[std::size_t(a)][1] < 0) != (mesh.nodes[std::size_t(b)][1] < 0)) {
        opposite[std::size_t(a)] = b;
        opposite[std::size_t(b)] = a;
      }
    }
  return opposite;
}

int corner_of(const std::array<NodeId, 8>& element, NodeId node) {
  for (int a = 0; a < 8; ++a)
    if (element[std::size_t(a)] == node) return a;
  expect(false, "a face's node belongs to its element");
  return 0;
}

/// Nodes along four columns of edges that start at the corners of `face` and run through its element, the element behind
/// it, and so on within one region.
struct Columns {
  std::array<std::vector<NodeId>, 4> nodes;
  FaceId last = no_face;     ///< where they end
  bool at_boundary = false;  ///< nothing lies behind
};

Columns walk(const Mesh& mesh, const std::vector<std::array<NodeId, 8>>& tied, const std::vector<FaceId>& match, FaceId face) {
  Columns c;
  const auto region = mesh.region[std::size_t(element_of(face))];
  const auto start = face_nodes(tied, face);
  for (std::size_t k = 0; k < 4; ++k) c.nodes[k] = {start[k]};
  for (std::size_t steps = 0; steps <= tied.size(); ++steps) {
    const auto& element = tied[std::size_t(element_of(face))];
    const int axis = side_of(face) / 2;
    for (auto& column : c.nodes) column.push_back(element[std::size_t(corner_of(element, column.back()) ^ (1 << axis))]);
    c.last = face ^ 1;  // 6 is even: the opposite side of the same element
    const FaceId behind = match[std::size_t(c.last)];
    if (behind == no_face || mesh.region[std::size_t(element_of(behind))] != region) {
      c.at_boundary = behind == no_face;
      return c;
    }
    face = behind;
  }
  expect(false, "columns of elements end");
  return c;
}

/// Whether a steel element behind a wetted face is the end of a plate: across it there is mercury on both sides, where a wall goes on to the outside.
bool is_end_of_plate(const Mesh& mesh, const std::vector<std::array<NodeId, 8>>& tied, const std::vector<FaceId>& match, FaceId face) {
  const FaceId first = FaceId(element_of(face)) * 6;
  const auto ends_in_mercury = [&](FaceId from) {
    const FaceId behind = match[std::size_t(walk(mesh, tied, match, from).last)];
    return behind != no_face && mesh.region[std::size_t(element_of(behind))] == Region::mercury;
  };
  for (int axis = 0; axis < 3; ++axis)
    if (axis != side_of(face) / 2 && ends_in_mercury(first + 2 * axis) && ends_in_mercury(first + 2 * axis + 1)) return true;
  return false;
}

/// Whether the wall that an outer normal belongs to has this name.
bool is_wall(const std::string& name, const Point& normal) {
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const bool positive = normal[axis] > 0;
  if (axis == 0) return name == (positive ? "rear" : "front");
  if (axis == 1) return name == "side";
  return name == (positive ? "top" : "bottom");
}

/// Lengths along a column from its first node.
std::vector<double> lengths_along(const Mesh& mesh, const std::vector<NodeId>& column) {
  std::vector<double> s{0};
  for (std::size_t i = 1; i < column.size(); ++i)
    s.push_back(s.back() + (hexahedron::point(mesh.nodes[std::size_t(column[i])]) - hexahedron::point(mesh.nodes[std::size_t(column[i - 1])])).norm());
  return s;
}

/// Calls f(face, behind, wall) for every face of a steel element with mercury behind it that belongs to a wall of this name, its columns being those through
/// the wall; without a name: of any, those of plates with mercury on both sides as well.
template <class F>
void for_wetted(const Mesh& mesh, const std::vector<std::array<NodeId, 8>>& tied, const std::vector<FaceId>& match, const std::string* name, F&& f) {
  for (FaceId face = 0; face < FaceId(match.size()); ++face) {
    const FaceId behind = match[std::size_t(face)];
    if (behind == no_face || mesh.region[std::size_t(element_of(face))] != Region::steel || mesh.region[std::size_t(element_of(behind))] != Region::mercury)
      continue;
    const Columns wall = walk(mesh, tied, match, face);
    if (name) {
      if (!wall.at_boundary || is_end_of_plate(mesh, tied, match, face)) continue;  // a plate with mercury behind it, or one that is seen from its end
      const Face outside{.nodes = face_nodes(tied, wall.last), .element = element_of(wall.last)};
      if (!is_wall(*name, hexahedron::area_vector(mesh, outside))) continue;
    }
    f(face, behind, wall);
  }
}

/// Shares of the wall about each node of its wetted side, from the middle of one face beside it to that of the next, that lie within the stretch; 0 of all
/// other nodes. An edge across the stretch's direction has no extent along it: in or out.
std::vector<double> shares_within(const Mesh& mesh, const std::vector<std::array<NodeId, 8>>& tied, const std::vector<FaceId>& match,
                                  const WallThinning& stretch) {
  const Eigen::Index axis = stretch.wall == "front" || stretch.wall == "rear" ? 2 : 0;
  const auto along = [&](NodeId n) { return hexahedron::point(mesh.nodes[std::size_t(n)])[axis]; };
  struct Extent {
    double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  };
  std::vector<Extent> extent(mesh.nodes.size());
  for_wetted(mesh, tied, match, stretch.wall == "all" ? nullptr : &stretch.wall, [&](FaceId face, FaceId, const Columns&) {
    const auto nodes = face_nodes(tied, face);
    double middle = 0;
    for (const NodeId n : nodes) middle += along(n) / double(nodes.size());
    for (const NodeId n : nodes) {
      Extent& e = extent[std::size_t(n)];
      e.low = std::min({e.low, middle, along(n)});
      e.high = std::max({e.high, middle, along(n)});
    }
  });
  std::vector<double> shares(extent.size(), 0.0);
  for (std::size_t n = 0; n < extent.size(); ++n) {
    const auto [low, high] = extent[n];
    if (!(low <= high)) continue;
    const double within = std::min(high, stretch.end) - std::max(low, stretch.begin);
    shares[n] = high > low ? std::clamp(within / (high - low), 0.0, 1.0) : double(within >= 0);
  }
  return shares;
}

}  // namespace

void displace_nodes(Mesh& mesh, std::span<const Vec3> displacement) {
  expect(displacement.size() == mesh.nodes.size(), "a displacement per node");
  auto before = mesh.nodes;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    for (std::size_t k = 0; k < 3; ++k) mesh.nodes[n][k] += displacement[n][k];
  for (const auto& pair : mesh.slip) mesh.nodes[std::size_t(pair.mercury)] = mesh.nodes[std::size_t(pair.steel)];
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    if (!(hexahedron::scaled_jacobian(hexahedron::corners(mesh, e)) > 0)) {
      mesh.nodes = std::move(before);
      throw NumericsError(fmt::format("element {} would be turned inside out by the displacement of the mesh", e));
    }
  update_slip_normals(mesh);
  mesh.quality = measure_quality(mesh);
  mesh.liquid_element_size = median_liquid_edge(mesh);
}

Mesh jittered(Mesh mesh, double fraction, RandomStream& random) {
  expect(fraction >= 0 && fraction <= 0.45, "the jitter is a fraction of an edge up to 0.45");
  const auto tied = tied_elements(mesh);
  const auto held = held_directions(mesh, tied, matching_faces(tied, mesh.nodes.size()));
  std::vector<double> edge(mesh.nodes.size(), std::numeric_limits<double>::infinity());
  for (const auto& e : tied)
    for (const auto& [a, b] : hexahedron::edges) {
      const auto i = std::size_t(e[std::size_t(a)]), j = std::size_t(e[std::size_t(b)]);
      const Point d = hexahedron::point(mesh.nodes[i]) - hexahedron::point(mesh.nodes[j]);
      if (mesh.plane_strain && std::abs(d.y()) > 0.7 * d.norm()) continue;
      edge[i] = std::min(edge[i], d.norm());
      edge[j] = std::min(edge[j], d.norm());
    }
  std::vector<Point> move(mesh.nodes.size(), Point::Zero());
  for (std::size_t n = 0; n < move.size(); ++n) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
    if (std::isfinite(edge[n])) move[n] = held[n].project(fraction * edge[n] * Point(x, y, z));
  }
  if (mesh.plane_strain) {
    const auto opposite = opposite_in_y(mesh, tied);
    for (std::size_t n = 0; n < move.size(); ++n)
      if (opposite[n] > NodeId(n)) move[std::size_t(opposite[n])] = move[n];
  }
  // Halve the moves about bad elements until there are none.
  const auto moved_corners = [&](std::size_t e) {
    auto x = hexahedron::corners(mesh, e);
    for (std::size_t a = 0; a < 8; ++a) x[a] += move[std::size_t(tied[e][a])];
    return x;
  };
  for (bool again = true; again;) {
    again = false;
    for (std::size_t e = 0; e < tied.size(); ++e) {
      const double floor = std::min(0.15, 0.5 * hexahedron::scaled_jacobian(hexahedron::corners(mesh, e)));
      if (hexahedron::scaled_jacobian(moved_corners(e)) >= floor) continue;
      for (const NodeId n : tied[e]) move[std::size_t(n)] /= 2;
      again = true;
    }
  }
  std::vector<Vec3> displacement(move.size());
  for (std::size_t n = 0; n < move.size(); ++n) displacement[n] = hexahedron::vec3(move[n]);
  displace_nodes(mesh, displacement);
  return mesh;
}

void thin_wall(Mesh& mesh, const WallThinning& thinning) {
  if (!(thinning.fraction >= 0 && thinning.fraction <= 0.9))
    throw InputError({.problem = "part of a wall's thickness that is gone", .key = "fraction", .value = number_text(thinning.fraction), .range = "[0, 0.9]"});
  const auto tied = tied_elements(mesh);
  const auto match = matching_faces(tied, mesh.nodes.size());
  std::vector<Point> move(mesh.nodes.size(), Point::Zero());
  const auto raise = [&](NodeId n, const Point& d) {
    if (auto& m = move[std::size_t(n)]; d.squaredNorm() > m.squaredNorm()) m = d;
  };
  bool found = false;
  const auto shares = shares_within(mesh, tied, match, thinning);
  for_wetted(mesh, tied, match, &thinning.wall, [&](FaceId, FaceId g, const Columns& wall) {
    found = true;
    const Columns liquid = walk(mesh, tied, match, g);
    for (const auto& column : wall.nodes) {
      const Point inner = hexahedron::point(mesh.nodes[std::size_t(column.front())]), outer = hexahedron::point(mesh.nodes[std::size_t(column.back())]);
      const double share = shares[std::size_t(column.front())];
      if (share == 0) continue;
      const Point d = share * thinning.fraction * (outer - inner);
      const auto s = lengths_along(mesh, column);
      for (std::size_t i = 0; i < column.size(); ++i) raise(column[i], d * (1 - s[i] / s.back()));
      for (const auto& below : liquid.nodes) {
        if (below.front() != column.front()) continue;
        const auto depth = lengths_along(mesh, below);
        for (std::size_t i = 0; i < below.size(); ++i) raise(below[i], d * std::max(0.0, 1 - 2 * depth[i] / depth.back()));
      }
    }
  });
  if (!found)
    throw InputError({.problem = "the target has no wall of this name between mercury and outside",
                      .key = "wall",
                      .value = '"' + thinning.wall + '"',
                      .range = "front, rear, side, top, bottom"});
  std::vector<Vec3> displacement(move.size());
  for (std::size_t n = 0; n < move.size(); ++n) displacement[n] = hexahedron::vec3(move[n]);
  displace_nodes(mesh, displacement);
}

std::vector<PairAtWall> pairs_at_wall(const Mesh& mesh, const WallThinning& stretch) {
  const auto tied = tied_elements(mesh);
  const auto shares = shares_within(mesh, tied, matching_faces(tied, mesh.nodes.size()), stretch);
  std::vector<PairAtWall> pairs;
  for (std::size_t i = 0; i < mesh.slip.size(); ++i)
    if (const double share = shares[std::size_t(mesh.slip[i].steel)]; share > 0) pairs.push_back({i, share});
  return pairs;
}

}  // namespace calomel
