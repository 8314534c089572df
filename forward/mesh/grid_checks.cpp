#include "forward/mesh/grid_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "base/errors.hpp"
#include "base/options.hpp"
#include "forward/mesh/hexahedron.hpp"

namespace calomel {
namespace {

using hexahedron::Point;

/// Sets that grow together; the least member represents each set.
class Joined {
 public:
  explicit Joined(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), NodeId{0}); }
  NodeId root(NodeId a) {
    while (parent_[std::size_t(a)] != a) a = parent_[std::size_t(a)] = parent_[std::size_t(parent_[std::size_t(a)])];
    return a;
  }
  void join(NodeId a, NodeId b) {
    a = root(a);
    b = root(b);
    parent_[std::size_t(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::vector<NodeId> parent_;
};

/// Pairs of nodes not farther apart than `distance`, by a grid of cells 16 times as large.
std::vector<std::pair<NodeId, NodeId>> near_pairs(const std::vector<Vec3>& nodes, double distance) {
  using Cell = std::array<std::int64_t, 3>;
  const auto hash = [](const Cell& c) {
    std::uint64_t h = 0;
    for (const auto k : c) {
      h = (h ^ std::uint64_t(k)) * 0x9e3779b97f4a7c15ull;
      h ^= h >> 29;
    }
    return h;
  };
  const double size = 16 * distance;
  const auto cell = [&](const Vec3& x, double shift_x, double shift_y, double shift_z) {
    return Cell{std::int64_t(std::floor((x[0] + shift_x) / size)), std::int64_t(std::floor((x[1] + shift_y) / size)),
                std::int64_t(std::floor((x[2] + shift_z) / size))};
  };
  std::unordered_multimap<std::uint64_t, NodeId> at;
  at.reserve(nodes.size());
  std::vector<std::pair<NodeId, NodeId>> pairs;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const Cell low = cell(nodes[n], -distance, -distance, -distance), high = cell(nodes[n], distance, distance, distance);
    for (auto i = low[0]; i <= high[0]; ++i)
      for (auto j = low[1]; j <= high[1]; ++j)
        for (auto k = low[2]; k <= high[2]; ++k) {
          const auto [first, last] = at.equal_range(hash({i, j, k}));
          for (auto it = first; it != last; ++it)
            if ((hexahedron::point(nodes[n]) - hexahedron::point(nodes[std::size_t(it->second)])).norm() <= distance) pairs.emplace_back(it->second, NodeId(n));
        }
    at.emplace(hash(cell(nodes[n], 0, 0, 0)), NodeId(n));
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

/// Gives every node the number `to` of it and leaves out those with -1; several may get the same.
void renumber(MeshFile& mesh, const std::vector<NodeId>& to) {
  std::vector<Vec3> nodes(std::size_t(to.empty() ? 0 : *std::max_element(to.begin(), to.end()) + 1));
  std::vector<std::int64_t> labels(nodes.size());
  for (std::size_t n = to.size(); n-- > 0;)
    if (to[n] >= 0) {
      nodes[std::size_t(to[n])] = mesh.nodes[n];
      labels[std::size_t(to[n])] = mesh.node_label[n];
    }
  mesh.nodes = std::move(nodes);
  mesh.node_label = std::move(labels);
  for (auto& e : mesh.elements)
    for (auto& n : e) n = to[std::size_t(n)];
  for (auto& [name, set] : mesh.node_sets) {
    for (auto& n : set) n = to[std::size_t(n)];
    std::erase(set, -1);
  }
}

hexahedron::Corners corners(const MeshFile& mesh, std::size_t e) {
  hexahedron::Corners x;
  for (std::size_t a = 0; a < 8; ++a) x[a] = hexahedron::point(mesh.nodes[std::size_t(mesh.elements[e][a])]);
  return x;
}

std::string place(const Vec3& x) { return fmt::format("({:.6g}, {:.6g}, {:.6g}) m", x[0], x[1], x[2]); }

bool names_a_node_twice(std::array<NodeId, 8> e) {
  std::sort(e.begin(), e.end());
  return std::adjacent_find(e.begin(), e.end()) != e.end();
}

void expect_shared(const MeshFile& mesh, std::span<const Region> region) {
  const double distance = 1e-6 * extent(mesh);
  const auto pairs = near_pairs(mesh.nodes, distance);
  if (pairs.empty()) return;
  std::vector<int> touches(mesh.nodes.size(), 0);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    for (const NodeId n : mesh.elements[e]) touches[std::size_t(n)] |= region[e] == Region::steel ? 1 : 2;
  const auto material = [&](NodeId n) { return std::array{"", "steel", "mercury", "steel and mercury"}[std::size_t(touches[std::size_t(n)])]; };
  const auto [a, b] = pairs.front();
  throw InputError(
      {.problem = fmt::format("parts touch without sharing nodes: {} pairs of nodes lie at the same place, the first of them nodes {} ({}) and {} ({}) at {}",
                              pairs.size(), mesh.node_label[std::size_t(a)], material(a), mesh.node_label[std::size_t(b)], material(b),
                              place(mesh.nodes[std::size_t(a)])),
       .suggestion = fmt::format("merge them in the mesh generator, or with geometry.merge_distance = {:.1g}; steel and mercury share nodes in the "
                                 "file, wetted = \"slip\" parts them",
                                 2 * distance),
       .file = mesh.path.string()});
}

}  // namespace

double extent(const MeshFile& mesh) {
  Point low = Point::Constant(1e300), high = Point::Constant(-1e300);
  for (const auto& x : mesh.nodes) {
    low = low.cwiseMin(hexahedron::point(x));
    high = high.cwiseMax(hexahedron::point(x));
  }
  return (high - low).norm();
}

std::size_t drop_loose_nodes(MeshFile& mesh) {
  std::vector<NodeId> to(mesh.nodes.size(), -1);
  for (const auto& e : mesh.elements)
    for (const NodeId n : e) to[std::size_t(n)] = 0;
  NodeId next = 0;
  for (auto& n : to)
    if (n == 0) n = next++;
  const std::size_t dropped = to.size() - std::size_t(next);
  if (dropped > 0) renumber(mesh, to);
  return dropped;
}

std::size_t merge_nodes(MeshFile& mesh, double distance) {
  Joined joined(mesh.nodes.size());
  for (const auto& [a, b] : near_pairs(mesh.nodes, distance)) joined.join(a, b);
  std::vector<NodeId> to(mesh.nodes.size());
  NodeId next = 0;
  for (std::size_t n = 0; n < to.size(); ++n) {
    const NodeId root = joined.root(NodeId(n));
    to[n] = root == NodeId(n) ? next++ : to[std::size_t(root)];
  }
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    auto merged = mesh.elements[e];
    for (auto& n : merged) n = to[std::size_t(n)];
    if (names_a_node_twice(merged))
      throw InputError({.problem = fmt::format("nodes of one element would become one: {} of {}", mesh.element_text(e), mesh.path.filename().string()),
                        .key = "merge_distance",
                        .value = number_text(distance),
                        .range = "less than the shortest edge",
                        .suggestion = fmt::format("try {:.1g}", 1e-6 * extent(mesh))});
  }
  renumber(mesh, to);
  return to.size() - std::size_t(next);
}

void expect_sound_elements(const MeshFile& mesh) {
  std::size_t bad = 0, left_handed = 0, first = 0, twice = 0;
  double worst = 0;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const auto x = corners(mesh, e);
    const double jacobian = hexahedron::scaled_jacobian(x);
    if (jacobian > 0) continue;
    if (bad++ == 0) {
      first = e;
      worst = jacobian;
    }
    left_handed += hexahedron::volume(x) < 0;
    twice += names_a_node_twice(mesh.elements[e]);
  }
  if (bad == 0) return;
  const bool wedge = names_a_node_twice(mesh.elements[first]);
  throw InputError(
      {.problem = wedge ? fmt::format("{} names a node twice, as a wedge or a pyramid does ({} of {} elements do)", mesh.element_text(first), twice,
                                      mesh.elements.size())
                        : fmt::format("{} at {} is turned inside out or has no volume, its least scaled Jacobian is {:.3g} ({} of {} elements)",
                                      mesh.element_text(first), place(mesh.nodes[std::size_t(mesh.elements[first][0])]), worst, bad, mesh.elements.size()),
       .range = "a scaled Jacobian above 0",
       .suggestion = left_handed == mesh.elements.size()
                         ? "every element has its nodes in left-handed order: write the lower face counter-clockwise, seen from above, and then the upper"
                         : "repair it in the mesh generator",
       .file = mesh.path.string(),
       .line = mesh.line_of(first)});
}

void expect_joined(const MeshFile& mesh, std::span<const Region> region) {
  expect_shared(mesh, region);
  Joined joined(mesh.nodes.size());
  for (const auto& e : mesh.elements)
    for (const NodeId n : e) joined.join(e[0], n);
  std::unordered_map<NodeId, std::size_t> elements;
  for (const auto& e : mesh.elements) ++elements[joined.root(e[0])];
  if (elements.size() == 1) return;
  const auto smallest = std::min_element(elements.begin(), elements.end(),
                                         [](const auto& a, const auto& b) { return a.second != b.second ? a.second < b.second : a.first < b.first; });
  std::size_t e = 0;
  while (joined.root(mesh.elements[e][0]) != smallest->first) ++e;
  throw InputError({.problem = fmt::format("the elements make {} pieces that share no node; the smallest has {} elements, among them {} at {}", elements.size(),
                                           smallest->second, mesh.element_text(e), place(mesh.nodes[std::size_t(mesh.elements[e][0])])),
                    .suggestion = "join the parts by shared nodes (geometry.merge_distance does it where their nodes lie together), or leave the piece out",
                    .file = mesh.path.string(),
                    .line = mesh.line_of(e)});
}

std::vector<FaceId> matching_faces(const MeshFile& mesh) {
  return matching_faces(mesh.elements, mesh.nodes.size(), [&](FaceId f, FaceId g) {
    const auto a = std::size_t(element_of(f)), b = std::size_t(element_of(g));
    throw InputError({.problem = fmt::format("three elements share one face, {} and {} among them", mesh.element_text(a), mesh.element_text(b)),
                      .suggestion = "does the file hold a part twice?",
                      .file = mesh.path.string(),
                      .line = mesh.line_of(std::max(a, b))});
  });
}

}  // namespace calomel
