#pragma once
/// Strain gauges on the outer surface: where they sit, and the linear functional of the nodal displacements that each one reads.
#include <span>
#include <string>
#include <vector>

#include "forward/mesh/surface_tree.hpp"
#include "forward/sensor/sensor_options.hpp"

namespace calomel {

/// A sparse linear functional of nodal displacements: sum_i weights[i] . u[nodes[i]].
struct GaugeRow {
  std::vector<NodeId> nodes;
  std::vector<Vec3> weights;  ///< [1/m]
  /// displacement: (nodes, 3) row-major [m]; result [-].
  [[nodiscard]] double operator()(std::span<const Vec3> displacement) const;
};

/// A gauge on a mesh. In a half or quarter model everything is mirrored into the part that is kept.
struct LocatedGauge {
  std::string name;
  Vec3 placed{};          ///< on the outer surface [m]
  Vec3 normal{};          ///< outward unit normal there
  Vec3 direction{};       ///< unit, tangential
  double distance = 0;    ///< from the position requested to `placed` [m]
  bool mirrored = false;  ///< the position requested lies in the part that is not kept
  GaugeRow axial;         ///< strain along the direction d
  GaugeRow transverse;    ///< strain along t = n x d, at the point
  GaugeRow shear;         ///< engineering shear strain gamma_dt, at the point
};

/// Gauges of one mesh; builds the search tree over its outer faces once. The mesh must outlive it.
class GaugeLocator {
 public:
  /// Errors: contract failure when the mesh has no outer surface.
  explicit GaugeLocator(const Mesh& mesh);

  /// With a gauge length l, strain along d is e.[u(b) - u(a)]/|b - a|, a and b the places on the surface nearest to
  /// x -+ l d/2, e their direction, u interpolated in the faces that hold them: exact in a linear displacement field, zero
  /// in a rigid motion. Without one, d.grad(u).d of the surface, face-centre gradients averaged to the nodes and
  /// interpolated. placement = "element_centre": d.grad(u).d at the centre of the element below.
  /// Errors: InputError on "position" (too far from the surface), "direction" (nearly along the normal),
  /// "gauge_length" (reaches over an edge), each naming the sensor.
  [[nodiscard]] LocatedGauge locate(const SensorOptions& sensor) const;

 private:
  const Mesh& mesh_;
  SurfaceTree tree_;
};

/// One gauge; where there are several, a GaugeLocator is cheaper.
[[nodiscard]] LocatedGauge locate_gauge(const Mesh& mesh, const SensorOptions& sensor);

}  // namespace calomel
