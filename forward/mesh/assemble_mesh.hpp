#pragma once
/// From a bare grid of steel and mercury to a Mesh: order, boundary faces, slip pairs, quality.
#include <functional>
#include <span>

#include "forward/mesh/hexahedron.hpp"

namespace calomel {

/// Nodes and elements as a generator makes them; steel and mercury share nodes. Consumed by `assemble_mesh`.
struct BareGrid {
  std::vector<Vec3> nodes;
  std::vector<std::array<NodeId, 8>> elements;
  std::vector<Region> region;
};

/// What a boundary face is.
enum class BoundaryKind { outer, symmetry_x, symmetry_y, symmetry_z, rear, loaded, free_end };

struct AssemblyOptions {
  bool slip = true;  ///< separate nodes on wetted faces
  bool plane_strain = false;
  std::vector<MirrorPlane> mirrors;
  int least_wall_elements = 0;  ///< as the generator knows it
  /// Kind of the boundary face with this centre [m] and outward unit normal.
  std::function<BoundaryKind(const hexahedron::Point& centre, const hexahedron::Point& normal)> boundary;
  /// Where set, in place of `boundary`: kind of the boundary face with these nodes of the bare grid.
  std::function<BoundaryKind(const std::array<NodeId, 4>& nodes)> boundary_of_nodes;
};

/// Elements sorted by region (steel first) and along a Morton walk, nodes numbered by first touch; wetted nodes split
/// and paired. Errors: contract failure when an element is inverted or mercury lies bare on an outer face.
Mesh assemble_mesh(BareGrid grid, const AssemblyOptions& options);

/// Sets count and normals of every slip pair from the wetted faces about it.
void update_slip_normals(Mesh& mesh);
/// Quality of the mesh, apart from `least_wall_elements`, which is kept.
MeshQuality measure_quality(const Mesh& mesh);
/// Median over the mercury elements of the shortest edge (in plane strain: of those not along y) [m]; 0 without mercury.
double median_liquid_edge(const Mesh& mesh);
/// Shortest edge of an element [m], in plane strain of those in the plane.
double shortest_edge(const Mesh& mesh, std::size_t element);

/// The distinct directions among area vectors: those within 40 degrees of each other, or of each other's opposite,
/// merge into their sum; `fixed` directions (bits 0, 1, 2 = x, y, z) are projected out. Orthonormal, at most 3.
int distinct_normals(std::span<const hexahedron::Point> areas, std::uint8_t fixed, std::array<Vec3, 3>& normals);

}  // namespace calomel
