#include "forward/mesh/face_sets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "forward/mesh/grid_checks.hpp"

namespace calomel {
namespace {

using hexahedron::Point;

[[noreturn]] void no_such_set(const std::string& key, const std::string& name, const std::vector<std::string>& there, const char* kind) {
  throw InputError({.problem = fmt::format("the mesh file has no {} set of this name", kind),
                    .key = "sets." + key,
                    .value = '"' + name + '"',
                    .range = there.empty() ? "none is there" : join(there),
                    .suggestion = there.empty() ? "name the sets in the mesh generator" : name_suggestion(lower_case(name), there)});
}

template <class Sets>
std::vector<std::string> names_in(const Sets& sets) {
  std::vector<std::string> names;
  for (const auto& [name, set] : sets) names.push_back(name);
  return names;
}

/// Adds `bit` to the elements of the sets that the key names, or by default of those that contain its name.
void mark_material(const MeshFile& mesh, const std::string& key, std::vector<std::string> names, std::uint8_t bit, std::vector<std::uint8_t>& material) {
  const auto there = names_in(mesh.element_sets);
  if (names.empty())
    for (const auto& name : there)
      if (name.find(key) != std::string::npos) names.push_back(name);
  for (const auto& name : names) {
    const auto set = mesh.element_sets.find(lower_case(name));
    if (set == mesh.element_sets.end()) no_such_set(key, name, there, "element");
    for (const auto e : set->second) material[std::size_t(e)] |= bit;
  }
}

std::string sets_of(const MeshFile& mesh, std::size_t element) {
  std::vector<std::string> in;
  for (const auto& [name, set] : mesh.element_sets)
    if (std::find(set.begin(), set.end(), std::int32_t(element)) != set.end()) in.push_back(name);
  return in.empty() ? "it is in no set" : "it is in " + join(in);
}

void refuse_material(const MeshFile& mesh, const std::vector<std::uint8_t>& material, std::uint8_t wrong, const std::string& problem) {
  const auto first = std::find(material.begin(), material.end(), wrong);
  if (first == material.end()) return;
  const auto e = std::size_t(first - material.begin());
  throw InputError(
      {.problem = fmt::format("{} of {} elements are {}, the first is {} ({})", std::count(material.begin(), material.end(), wrong), material.size(), problem,
                              mesh.element_text(e), sets_of(mesh, e)),
       .suggestion = fmt::format("name the sets with geometry.sets.steel and geometry.sets.mercury; those there are {}", join(names_in(mesh.element_sets))),
       .file = mesh.path.string(),
       .line = mesh.line_of(e)});
}

/// Sets the kinds of free faces, one key after another.
class Marker {
 public:
  Marker(const MeshFile& mesh, std::span<const FaceId> match) : mesh_(mesh), place_(match.size(), -1), tolerance_(1e-6 * extent(mesh)) {
    out_.symmetric.assign(match.size(), false);
    for (FaceId f = 0; f < FaceId(match.size()); ++f)
      if (match[std::size_t(f)] == no_face) {
        place_[std::size_t(f)] = std::int32_t(out_.face.size());
        out_.face.push_back(f);
      }
    out_.kind.assign(out_.face.size(), BoundaryKind::free_end);
    key_.assign(out_.face.size(), nullptr);
  }

  /// Free faces that the key's sets name (node sets: all four nodes); none when it names none and no set has its name.
  std::vector<FaceId> faces(const char* key, std::vector<std::string> names, int axis) {
    if (names.empty() && (mesh_.side_sets.contains(key) || mesh_.node_sets.contains(key))) names = {key};
    std::vector<FaceId> all;
    for (const auto& given : names) {
      const std::string name = lower_case(given);
      const auto sides = mesh_.side_sets.find(name);
      const auto nodes = mesh_.node_sets.find(name);
      const std::size_t before = all.size();
      if (sides != mesh_.side_sets.end())
        for (const FaceId f : sides->second) all.push_back(checked_side(key, given, f, axis));
      else if (nodes != mesh_.node_sets.end())
        faces_of_nodes(key, given, nodes->second, axis, all);
      else {
        auto there = names_in(mesh_.side_sets);
        for (const auto& n : names_in(mesh_.node_sets)) there.push_back(n);
        no_such_set(key, given, there, "node or side");
      }
      if (all.size() == before)
        throw InputError({.problem = axis < 0 ? "no free face lies in this set" : fmt::format("no free face normal to {} lies in this set", "xyz"[axis]),
                          .key = std::string("sets.") + key,
                          .value = '"' + given + '"',
                          .suggestion = "a face lies in a node set when its four nodes do"});
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  /// `weak` leaves faces alone that already have a kind.
  void mark(const char* key, const std::vector<FaceId>& faces, BoundaryKind kind, bool weak = false) {
    for (const FaceId f : faces) {
      const auto i = std::size_t(place_[std::size_t(f)]);
      if (key_[i] && weak) continue;
      if (key_[i])
        throw InputError({.problem = fmt::format("a side of {} is in sets.{} as well", mesh_.element_text(std::size_t(element_of(f))), key_[i]),
                          .key = std::string("sets.") + key});
      key_[i] = key;
      out_.kind[i] = kind;
    }
  }

  /// A symmetry plane: marked, held to be plane, and mirrored when only one side of the mesh has it.
  void mark_symmetry(int axis, const std::vector<std::string>& names, BoundaryKind kind) {
    static constexpr std::array keys{"symmetry_x", "symmetry_y", "symmetry_z"};
    const auto all = faces(keys[std::size_t(axis)], names, axis);
    if (all.empty()) return;
    mark(keys[std::size_t(axis)], all, kind);
    double low = 1e300, high = -1e300;
    bool below = false, above = false;
    for (const FaceId f : all) {
      out_.symmetric[std::size_t(f)] = true;
      (normal(f)[axis] > 0 ? above : below) = true;
      for (const NodeId n : face_nodes(mesh_.elements, f)) {
        low = std::min(low, mesh_.nodes[std::size_t(n)][std::size_t(axis)]);
        high = std::max(high, mesh_.nodes[std::size_t(n)][std::size_t(axis)]);
      }
    }
    if (axis == 1 && above && below) out_.plane_strain = is_one_layer(all);
    if (above && below) return;
    if (high - low > tolerance_)
      throw InputError({.problem = fmt::format("its faces lie between {0} = {1:.6g} and {2:.6g} m, in no one plane", "xyz"[axis], low, high),
                        .key = std::string("sets.") + keys[std::size_t(axis)]});
    out_.mirrors.push_back({.axis = axis, .at = low, .above = below});
  }

  [[nodiscard]] bool marked(std::size_t i) const { return key_[i] != nullptr; }
  [[nodiscard]] const char* key(std::size_t i) const { return key_[i]; }
  FreeFaces take() { return std::move(out_); }
  FreeFaces& faces_so_far() { return out_; }

 private:
  [[nodiscard]] Point normal(FaceId f) const {
    const auto n = face_nodes(mesh_.elements, f);
    const auto p = [&](std::size_t i) { return hexahedron::point(mesh_.nodes[std::size_t(n[i])]); };
    return (p(2) - p(0)).cross(p(3) - p(1)).normalized();
  }
  [[nodiscard]] bool along(FaceId f, int axis) const { return std::abs(normal(f)[axis]) > 1 - 1e-4; }

  FaceId checked_side(const char* key, const std::string& name, FaceId f, int axis) const {
    const std::string where = mesh_.element_text(std::size_t(element_of(f)));
    if (place_[std::size_t(f)] < 0)
      throw InputError({.problem = fmt::format("it holds a side of {} that is not free, another element lies behind it", where),
                        .key = std::string("sets.") + key,
                        .value = '"' + name + '"'});
    if (axis >= 0 && !along(f, axis)) {
      const Point n = normal(f);
      throw InputError({.problem = fmt::format("it holds a side of {} whose normal is ({:.3g}, {:.3g}, {:.3g})", where, n.x(), n.y(), n.z()),
                        .key = std::string("sets.") + key,
                        .value = '"' + name + '"',
                        .range = fmt::format("faces normal to {}", "xyz"[axis])});
    }
    return f;
  }

  void faces_of_nodes(const char* key, const std::string& name, const std::vector<NodeId>& nodes, int axis, std::vector<FaceId>& all) const {
    std::vector<std::uint8_t> in(mesh_.nodes.size(), 0);
    for (const NodeId n : nodes) in[std::size_t(n)] = 1;
    for (const FaceId f : out_.face) {
      const auto corners = face_nodes(mesh_.elements, f);
      const bool whole = std::all_of(corners.begin(), corners.end(), [&](NodeId n) { return in[std::size_t(n)] != 0; });
      if (!whole || (axis >= 0 && !along(f, axis))) continue;
      all.push_back(f);
      for (const NodeId n : corners) in[std::size_t(n)] = 2;
    }
    if (axis < 0) return;
    const auto loose = std::find(in.begin(), in.end(), 1);
    if (loose != in.end() && std::find(in.begin(), in.end(), 2) != in.end())
      throw InputError({.problem = fmt::format("{} of its nodes lie on no free face normal to {}, the first is node {}", std::count(in.begin(), in.end(), 1),
                                               "xyz"[axis], mesh_.node_label[std::size_t(loose - in.begin())]),
                        .key = std::string("sets.") + key,
                        .value = '"' + name + '"',
                        .suggestion = "a node set of a symmetry plane holds the nodes of whole faces"});
  }

  /// Whether each element has a symmetric face at either end, the one the other's image along y.
  [[nodiscard]] bool is_one_layer(const std::vector<FaceId>& faces) const {
    if (faces.size() != 2 * mesh_.elements.size()) return false;
    for (const FaceId f : faces) {
      if (!out_.symmetric[std::size_t(f)]) continue;  // its opposite is tested in turn
      const auto& e = mesh_.elements[std::size_t(element_of(f))];
      const int step = 1 << (side_of(f) / 2);
      for (const NodeId n : face_nodes(mesh_.elements, f)) {
        const auto corner = std::size_t(std::find(e.begin(), e.end(), n) - e.begin());
        const Vec3 &a = mesh_.nodes[std::size_t(n)], &b = mesh_.nodes[std::size_t(e[corner ^ std::size_t(step)])];
        if (std::hypot(a[0] - b[0], a[2] - b[2]) > tolerance_) return false;
      }
    }
    return true;
  }

  const MeshFile& mesh_;
  FreeFaces out_;
  std::vector<std::int32_t> place_;  ///< of a face among the free ones, or -1
  std::vector<const char*> key_;     ///< that marked a free face
  double tolerance_;
};

Point centre(const MeshFile& mesh, FaceId f) {
  Point c = Point::Zero();
  for (const NodeId n : face_nodes(mesh.elements, f)) c += hexahedron::point(mesh.nodes[std::size_t(n)]) / 4;
  return c;
}

}  // namespace

std::vector<Region> materials_of(const MeshFile& mesh, const SetOptions& sets) {
  std::vector<std::uint8_t> material(mesh.elements.size(), 0);
  mark_material(mesh, "steel", sets.steel, 1, material);
  mark_material(mesh, "mercury", sets.mercury, 2, material);
  refuse_material(mesh, material, 0, "neither steel nor mercury");
  refuse_material(mesh, material, 3, "both steel and mercury");
  std::vector<Region> region;
  for (const auto m : material) region.push_back(m == 1 ? Region::steel : Region::mercury);
  return region;
}

FreeFaces free_faces(const MeshFile& mesh, const SetOptions& sets, std::span<const Region> region, std::span<const FaceId> match) {
  Marker marker(mesh, match);
  marker.mark_symmetry(0, sets.symmetry_x, BoundaryKind::symmetry_x);
  marker.mark_symmetry(1, sets.symmetry_y, BoundaryKind::symmetry_y);
  marker.mark_symmetry(2, sets.symmetry_z, BoundaryKind::symmetry_z);
  marker.mark("rear", marker.faces("rear", sets.rear, -1), BoundaryKind::rear);
  marker.mark("loaded", marker.faces("loaded", sets.loaded, -1), BoundaryKind::loaded);
  const auto outer = marker.faces("outer", sets.outer, -1);
  marker.mark("outer", outer, BoundaryKind::outer, true);

  FreeFaces& out = marker.faces_so_far();
  std::size_t bare = 0, first = 0;
  for (std::size_t i = 0; i < out.face.size(); ++i) {
    const auto kind = out.kind[i];
    const bool liquid = region[std::size_t(element_of(out.face[i]))] == Region::mercury;
    if (!marker.marked(i) && !liquid && outer.empty()) out.kind[i] = BoundaryKind::outer;
    if (!liquid || kind == BoundaryKind::rear || out.symmetric[std::size_t(out.face[i])]) continue;
    if (bare++ == 0) first = i;
  }
  if (bare > 0) {
    const auto e = std::size_t(element_of(out.face[first]));
    const Point c = centre(mesh, out.face[first]);
    throw InputError({.problem = fmt::format("mercury lies bare on {} free faces, the first of {} at ({:.6g}, {:.6g}, {:.6g}) m", bare, mesh.element_text(e),
                                             c.x(), c.y(), c.z()),
                      .range = "mercury ends at steel whose nodes it shares, in sets.rear, or in a symmetry plane",
                      .suggestion = "join it to the steel there, or name its faces with geometry.sets",
                      .file = mesh.path.string(),
                      .line = mesh.line_of(e)});
  }
  return marker.take();
}

}  // namespace calomel
