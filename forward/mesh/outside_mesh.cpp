#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "forward/mesh/face_sets.hpp"
#include "forward/mesh/grid_checks.hpp"
#include "forward/mesh/make_mesh.hpp"
#include "forward/mesh/wall_layers.hpp"

namespace calomel {
namespace {

/// Steel and mercury must meet in whole faces: a node that both have lies on a face between them.
void expect_wetted_faces(const MeshFile& mesh, std::span<const Region> region, std::span<const FaceId> match) {
  std::vector<std::uint8_t> touches(mesh.nodes.size(), 0);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    for (const NodeId n : mesh.elements[e]) touches[std::size_t(n)] |= region[e] == Region::steel ? 1 : 2;
  for (FaceId f = 0; f < FaceId(match.size()); ++f) {
    const FaceId g = match[std::size_t(f)];
    if (g == no_face || region[std::size_t(element_of(f))] == region[std::size_t(element_of(g))]) continue;
    for (const NodeId n : face_nodes(mesh.elements, f)) touches[std::size_t(n)] = 0;
  }
  const auto lone = std::find(touches.begin(), touches.end(), 3);
  if (lone == touches.end()) return;
  const auto& x = mesh.nodes[std::size_t(lone - touches.begin())];
  throw InputError(
      {.problem = fmt::format("steel and mercury share {} nodes but no face there, the first is node {} at ({:.6g}, {:.6g}, {:.6g}) m",
                              std::count(touches.begin(), touches.end(), 3), mesh.node_label[std::size_t(lone - touches.begin())], x[0], x[1], x[2]),
       .suggestion = "let them meet in whole faces of elements, or not at all",
       .file = mesh.path.string()});
}

/// Moves a slice of one layer so that y = 0 runs through it, as gauges expect.
void centre_slice(MeshFile& mesh) {
  const auto [low, high] = std::minmax_element(mesh.nodes.begin(), mesh.nodes.end(), [](const Vec3& a, const Vec3& b) { return a[1] < b[1]; });
  const double bottom = (*low)[1], top = (*high)[1], middle = (bottom + top) / 2;
  if (bottom < 0 && top > 0) return;
  for (auto& x : mesh.nodes) x[1] -= middle;
  mesh.notes.push_back(fmt::format("the plane-strain slice at y = {:.4g} to {:.4g} m is taken to y = 0, on which nothing depends", bottom, top));
}

void check_walls(const MeshFile& mesh, const WallLayers& walls) {
  if (walls.elements != 1) return;
  const auto e = std::size_t(walls.first);
  throw InputError(
      {.problem = fmt::format(
           "one element through a wall cannot represent its bending: {} at x = {:.4g}, y = {:.4g}, z = {:.4g} m is the only one between two faces of the steel",
           mesh.element_text(e), mesh.nodes[std::size_t(mesh.elements[e][0])][0], mesh.nodes[std::size_t(mesh.elements[e][0])][1],
           mesh.nodes[std::size_t(mesh.elements[e][0])][2]),
       .range = "at least 2; 3 or more show the bending strain within 4 %",
       .suggestion = "mesh the walls more finely",
       .file = mesh.path.string(),
       .line = mesh.line_of(e)});
}

void repair(MeshFile& mesh, const GeometryOptions& g) {
  for (auto& x : mesh.nodes)
    for (double& c : x) c *= g.scale;
  if (const auto loose = drop_loose_nodes(mesh))
    mesh.notes.push_back(fmt::format("{} nodes of {} belong to no element and are left out", loose, mesh.path.filename().string()));
  expect_sound_elements(mesh);
  if (g.merge_distance > 0)
    mesh.notes.push_back(fmt::format("{} nodes nearer than {:.3g} m to another were merged", merge_nodes(mesh, g.merge_distance), g.merge_distance));
  if (const double size = extent(mesh); size > 20)
    mesh.notes.push_back(fmt::format("the mesh is {:.4g} m across; geometry.scale = 0.001 reads a file in millimetres", size));
}

}  // namespace

Mesh make_outside_mesh(const GeometryOptions& g) {
  g.validate();
  MeshFile file = read_mesh_file(g.mesh_file());
  if (double(file.elements.size()) > g.max_elements)
    throw InputError(
        {.problem = fmt::format("the mesh has {} elements", file.elements.size()), .key = "max_elements", .value = fmt::format("{:.3g}", g.max_elements)});
  repair(file, g);
  const auto match = matching_faces(file);
  const auto region = materials_of(file, g.sets);
  expect_joined(file, region);
  expect_wetted_faces(file, region, match);
  FreeFaces free = free_faces(file, g.sets, region, match);
  if (std::find(free.kind.begin(), free.kind.end(), BoundaryKind::outer) == free.kind.end())
    throw InputError({.problem = "no free steel face is left for gauges: all are in symmetry planes, loaded or in rear", .key = "sets.outer"});
  if (free.plane_strain) centre_slice(file);

  AssemblyOptions assembly;
  assembly.slip = g.slips();
  assembly.plane_strain = free.plane_strain;
  assembly.mirrors = free.mirrors;
  if (std::find(region.begin(), region.end(), Region::mercury) != region.end()) {
    const auto walls = least_wall_layers(region, match, free.symmetric);
    check_walls(file, walls);
    assembly.least_wall_elements = walls.elements;
  }
  const auto key = [](std::array<NodeId, 4> nodes) {
    std::sort(nodes.begin(), nodes.end());
    return nodes;
  };
  std::map<std::array<NodeId, 4>, BoundaryKind> kind;
  for (std::size_t i = 0; i < free.face.size(); ++i) kind[key(face_nodes(file.elements, free.face[i]))] = free.kind[i];
  assembly.boundary_of_nodes = [&](const std::array<NodeId, 4>& nodes) { return kind.at(key(nodes)); };
  Mesh mesh = assemble_mesh({.nodes = std::move(file.nodes), .elements = std::move(file.elements), .region = region}, assembly);
  mesh.notes = std::move(file.notes);
  return mesh;
}

}  // namespace calomel
