#pragma once
/// Layers of steel and mercury along a line, divided evenly.
#include <vector>

#include "forward/mesh/geometry_options.hpp"
#include "forward/mesh/mesh.hpp"

namespace calomel {

/// Grid points along one coordinate, and what lies between them.
struct LayeredLine {
  std::vector<double> points;   ///< [m]
  std::vector<Region> between;  ///< one fewer than points
  explicit LayeredLine(double start) : points{start} {}

  /// Adds `n` even intervals from the last point to `end`, which is met exactly.
  void add(double end, int n, Region region) {
    const double start = points.back();
    for (int i = 1; i < n; ++i) points.push_back(start + (end - start) * i / n);
    points.push_back(end);
    between.insert(between.end(), std::size_t(n), region);
  }
  /// The same, as many as the geometry's element_size and wall_elements request; walls are steel.
  void add(double end, const GeometryOptions& g, Region region) { add(end, g.divisions(end - points.back(), region == Region::steel), region); }
};

/// The layers across y: mercury and side walls, both sides or y >= 0 only; in plane strain one interval of element_size.
inline LayeredLine layers_across(const GeometryOptions& g) {
  if (g.plane_strain) {
    LayeredLine y(-*g.element_size / 2);
    y.add(*g.element_size / 2, 1, Region::mercury);
    return y;
  }
  const double outer = *g.width / 2, inner = outer - g.wall_thickness("side");
  LayeredLine y(g.half ? 0 : -outer);
  if (!g.half) y.add(-inner, g, Region::steel);
  y.add(inner, g, Region::mercury);
  y.add(outer, g, Region::steel);
  return y;
}

}  // namespace calomel
