#pragma once
/// The discretised target: hexahedra, fixed and slipping nodes, and the faces that loads, boundaries and gauges need.
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace calomel {

using Vec3 = std::array<double, 3>;
using NodeId = std::int32_t;

enum class Region : std::uint8_t { steel = 0, mercury = 1 };

/// A quadrilateral face; nodes run counter-clockwise seen from outside `element`, so that the normal points out of it.
struct Face {
  std::array<NodeId, 4> nodes;
  std::int32_t element;
};

/// A steel and a mercury node at the same place on a wetted face. They move together along `normals[0..count)`
/// (orthonormal; 1 on a face, 2 along an edge between two wetted faces, 3 in a corner) and independently otherwise.
/// normals[0..count) point out of the mercury where that has a meaning (count == 1).
struct SlipPair {
  NodeId steel;
  NodeId mercury;
  int count;
  std::array<Vec3, 3> normals;
};

/// Worst and mean element quality, for `check` and the report.
struct MeshQuality {
  double least_scaled_jacobian = 1;             ///< over all corners, 1 = right angles [-]
  double greatest_aspect_ratio = 1;             ///< longest to shortest edge of an element [-]
  double shortest_edge = 0;                     ///< [m]
  double steel_volume = 0, mercury_volume = 0;  ///< [m^3]
  int least_wall_elements = 0;                  ///< fewest elements through any steel wall (0 = no walls)
};

/// A plane of symmetry, x[axis] = at [m], beyond which the target goes on as a mirror image that is not meshed.
struct MirrorPlane {
  int axis = 1;
  double at = 0;
  bool above = true;  ///< the meshed part lies at greater coordinates
};

struct Mesh {
  std::vector<Vec3> nodes;                      ///< reference coordinates [m]
  std::vector<std::array<NodeId, 8>> elements;  ///< corner i + 2j + 4k at (xi, eta, zeta) = (+-1): bit set means +1; right-handed
  std::vector<Region> region;                   ///< per element
  std::vector<std::uint8_t> fixed;              ///< per node: bit 0, 1, 2 set when the x, y, z displacement is zero (symmetry)
  std::vector<SlipPair> slip;                   ///< empty when wetted = "tied" (shared nodes) or there is no mercury
  std::vector<Face> outer;                      ///< outer steel surface: where gauges may sit
  std::vector<Face> wetted;                     ///< faces of mercury elements that touch steel
  std::vector<Face> rear;                       ///< mercury faces of a non-reflecting rear end
  std::vector<Face> loaded;                     ///< faces on which an end_stress acts (bar: x = 0)
  bool plane_strain = false;                    ///< one element across y, both y faces symmetric
  std::vector<MirrorPlane> mirrors;             ///< at most one an axis; gauges beyond are mirrored into the meshed part
  double liquid_element_size = 0;               ///< h of the regularising viscosity: median over mercury elements of the shortest in-plane edge [m]
  MeshQuality quality;
  std::vector<std::string> notes;  ///< remarks of the reader of a mesh file
};

/// Whether only the part on one side of a plane across this axis is modelled.
inline bool mirrored(const Mesh& mesh, int axis) {
  return std::any_of(mesh.mirrors.begin(), mesh.mirrors.end(), [axis](const MirrorPlane& m) { return m.axis == axis; });
}

/// How many times the modelled part the whole target is.
inline double symmetry_factor(const Mesh& mesh) { return double(1 << mesh.mirrors.size()); }

}  // namespace calomel
