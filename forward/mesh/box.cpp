#include <cmath>

#include "forward/mesh/assemble_mesh.hpp"
#include "forward/mesh/layers.hpp"
#include "forward/mesh/make_mesh.hpp"

namespace calomel {

Mesh make_box(const GeometryOptions& options) {
  options.validate();
  const GeometryOptions g = options.resolved();
  const double length = *g.length, height = *g.height;
  const bool rear_wall = g.rear == "wall";

  LayeredLine x(0), z(0);
  x.add(g.wall_thickness("front"), g, Region::steel);
  x.add(rear_wall ? length - g.wall_thickness("rear") : length, g, Region::mercury);
  if (rear_wall) x.add(length, g, Region::steel);
  const LayeredLine y = layers_across(g);
  z.add(g.wall_thickness("bottom"), g, Region::steel);
  z.add(height - g.wall_thickness("top"), g, Region::mercury);
  z.add(height, g, Region::steel);

  BareGrid grid;
  const std::size_t nx = x.points.size(), ny = y.points.size(), nz = z.points.size();
  grid.nodes.reserve(nx * ny * nz);
  for (const double pz : z.points)
    for (const double py : y.points)
      for (const double px : x.points) grid.nodes.push_back({px, py, pz});
  const auto node = [&](std::size_t i, std::size_t j, std::size_t k) { return NodeId((k * ny + j) * nx + i); };
  grid.elements.reserve((nx - 1) * (ny - 1) * (nz - 1));
  for (std::size_t k = 0; k + 1 < nz; ++k)
    for (std::size_t j = 0; j + 1 < ny; ++j)
      for (std::size_t i = 0; i + 1 < nx; ++i) {
        std::array<NodeId, 8> e;
        for (std::size_t a = 0; a < 8; ++a) e[a] = node(i + (a & 1), j + (a >> 1 & 1), k + (a >> 2));
        grid.elements.push_back(e);
        const bool liquid = x.between[i] == Region::mercury && y.between[j] == Region::mercury && z.between[k] == Region::mercury;
        grid.region.push_back(liquid ? Region::mercury : Region::steel);
      }

  AssemblyOptions assembly;
  assembly.slip = g.slips();
  assembly.plane_strain = g.plane_strain;
  if (g.half && !g.plane_strain) assembly.mirrors = {{.axis = 1}};
  assembly.least_wall_elements =
      std::min({g.divisions(g.wall_thickness("front"), true), g.divisions(g.wall_thickness("bottom"), true), g.divisions(g.wall_thickness("top"), true)});
  if (rear_wall) assembly.least_wall_elements = std::min(assembly.least_wall_elements, g.divisions(g.wall_thickness("rear"), true));
  if (!g.plane_strain) assembly.least_wall_elements = std::min(assembly.least_wall_elements, g.divisions(g.wall_thickness("side"), true));
  assembly.boundary = [&](const hexahedron::Point& centre, const hexahedron::Point& normal) {
    if (g.plane_strain && std::abs(normal.y()) > 0.5) return BoundaryKind::symmetry_y;
    if (g.half && normal.y() < -0.5 && std::abs(centre.y()) < 1e-9 * *g.width) return BoundaryKind::symmetry_y;
    if (!rear_wall && normal.x() > 0.5) return BoundaryKind::rear;
    return BoundaryKind::outer;
  };
  return assemble_mesh(std::move(grid), assembly);
}

Mesh make_mesh(const GeometryOptions& options) {
  options.validate();
  if (options.kind == "mesh") return make_outside_mesh(options);
  if (options.kind == "bar") return make_bar(options);
  if (options.kind == "jet_flow") return make_jet_flow(options);
  return make_box(options);
}

}  // namespace calomel
