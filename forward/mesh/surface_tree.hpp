#pragma once
/// Nearest place on a surface of bilinear faces, in logarithmic time.
#include <array>
#include <span>
#include <vector>

#include "forward/mesh/hexahedron.hpp"

namespace calomel {

/// A place on a face: bilinear coordinates in [-1, 1] and the weights of the face's four nodes there.
struct SurfacePoint {
  std::int32_t face = -1;  ///< position in the surface's list
  double xi = 0, eta = 0;
  std::array<double, 4> weights{};
  hexahedron::Point position;  ///< [m]
  hexahedron::Point normal;    ///< unit, outward
  double distance = 0;         ///< from the point requested [m]
};

/// Bounding-box tree over faces of `mesh`; both must outlive it.
class SurfaceTree {
 public:
  /// Errors: contract failure when there are no faces.
  SurfaceTree(const Mesh& mesh, std::span<const Face> faces);

  /// The nearest place. Among faces that are equally near (an edge between two), the one whose normal is least along
  /// `tangent` wins, so that a gauge on an edge sits on the face that it can measure.
  [[nodiscard]] SurfacePoint nearest(const hexahedron::Point& p, const hexahedron::Point& tangent = hexahedron::Point::Zero()) const;

  /// Faces that share node `node` (any corner of face `face`), `face` included.
  [[nodiscard]] std::span<const std::int32_t> faces_at(NodeId node) const;

  [[nodiscard]] const Face& face(std::int32_t f) const { return faces_[std::size_t(f)]; }

 private:
  struct Box {
    hexahedron::Point low, high;
    std::int32_t left = -1, right = -1;  ///< children, or -1
    std::int32_t begin = 0, end = 0;     ///< faces of a leaf in order_
  };
  std::int32_t build(std::int32_t begin, std::int32_t end);
  [[nodiscard]] SurfacePoint project(std::int32_t f, const hexahedron::Point& p) const;

  const Mesh& mesh_;
  std::span<const Face> faces_;
  std::vector<hexahedron::Point> centres_;
  std::vector<std::int32_t> order_;
  std::vector<Box> boxes_;
  std::vector<NodeId> node_;              ///< sorted nodes of the surface
  std::vector<std::int32_t> node_begin_;  ///< into node_faces_
  std::vector<std::int32_t> node_faces_;
};

/// Derivatives of the four bilinear weights by xi and eta.
struct BilinearDerivatives {
  std::array<double, 4> xi, eta;
};
std::array<double, 4> bilinear_weights(double xi, double eta);
BilinearDerivatives bilinear_derivatives(double xi, double eta);

}  // namespace calomel
