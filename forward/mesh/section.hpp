#pragma once
/// Plane sections of quadrilaterals, extruded to hexahedra.
#include <Eigen/Core>
#include <functional>

#include "forward/mesh/assemble_mesh.hpp"
#include "forward/mesh/layers.hpp"

namespace calomel {

/// A section in coordinates (a, b). Quadrilaterals may run either way round.
struct Section {
  std::vector<Eigen::Vector2d> points;
  std::vector<std::array<NodeId, 4>> quads;
  std::vector<Region> region;  ///< per quadrilateral
};

/// One hexahedron per quadrilateral and interval of `along`; mercury where both are. `place` gives the coordinates of
/// (a, b) at c; (a, b, c) must be right-handed.
BareGrid extrude(const Section& section, const LayeredLine& along, const std::function<Vec3(double a, double b, double c)>& place);

/// Transfinite interpolation (Gordon and Hall 1973): inner points of an (n + 1) x (m + 1) patch from its edges.
/// point(i, j) must be valid for i in {0, n} and for j in {0, m}.
Eigen::Vector2d transfinite(const std::function<Eigen::Vector2d(int i, int j)>& point, int i, int j, int n, int m);

}  // namespace calomel
