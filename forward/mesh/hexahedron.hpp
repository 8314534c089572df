#pragma once
/// Geometry of one hexahedron whose corner i + 2j + 4k lies at (xi, eta, zeta) = (2i-1, 2j-1, 2k-1).
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>

#include "forward/mesh/mesh.hpp"

namespace calomel::hexahedron {

using Point = Eigen::Vector3d;
using Corners = std::array<Point, 8>;

/// Corners of the faces -x, +x, -y, +y, -z, +z, counter-clockwise seen from outside; the opposite of face f is f ^ 1.
inline constexpr std::array<std::array<int, 4>, 6> faces{{{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

/// Pairs of corners of the 12 edges: 4 along xi, 4 along eta, 4 along zeta.
inline constexpr std::array<std::array<int, 2>, 12> edges{{{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

inline Point point(const Vec3& v) { return {v[0], v[1], v[2]}; }
inline Vec3 vec3(const Point& p) { return {p.x(), p.y(), p.z()}; }

inline Corners corners(const Mesh& mesh, std::size_t element) {
  Corners c;
  for (int a = 0; a < 8; ++a) c[std::size_t(a)] = point(mesh.nodes[std::size_t(mesh.elements[element][std::size_t(a)])]);
  return c;
}

/// Volume of the trilinear hexahedron [m^3], exact for warped faces (Grandy, Efficient computation of volume of
/// hexahedral cells, UCRL-ID-128886, 1997, the form with three determinants).
inline double volume(const Corners& x) {
  // Grandy's corners run round the bottom and then round the top.
  const auto &a0 = x[0], &a1 = x[1], &a2 = x[3], &a3 = x[2], &a4 = x[4], &a5 = x[5], &a6 = x[7], &a7 = x[6];
  const auto det = [](const Point& p, const Point& q, const Point& r) { return p.dot(q.cross(r)); };
  return (det((a3 - a1) + (a7 - a2), a6 - a3, a2 - a0) + det((a4 - a3) + (a5 - a7), a6 - a4, a7 - a0) + det((a1 - a4) + (a2 - a5), a6 - a1, a5 - a0)) / 12;
}

/// Least over the corners of det(e1, e2, e3)/(|e1||e2||e3|) [-]; 1 = right angles, <= 0 = inverted (Knupp 2000).
inline double scaled_jacobian(const Corners& x) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < 8; ++a) {
    const Point e1 = (x[a | 1] - x[a & 6]), e2 = (x[a | 2] - x[a & 5]), e3 = (x[a | 4] - x[a & 3]);
    const double lengths = std::sqrt(e1.squaredNorm() * e2.squaredNorm() * e3.squaredNorm());
    least = std::min(least, lengths > 0 ? e1.dot(e2.cross(e3)) / lengths : 0.0);
  }
  return least;
}

/// Squared lengths of the 12 edges [m^2], in the order of `edges`.
inline std::array<double, 12> squared_edges(const Corners& x) {
  std::array<double, 12> s;
  for (std::size_t e = 0; e < 12; ++e) s[e] = (x[std::size_t(edges[e][1])] - x[std::size_t(edges[e][0])]).squaredNorm();
  return s;
}

/// Area vector of a face [m^2]: half the cross product of its diagonals, the integral of the normal over the bilinear face.
inline Point area_vector(const Mesh& mesh, const Face& face) {
  const auto p = [&](std::size_t i) { return point(mesh.nodes[std::size_t(face.nodes[i])]); };
  return 0.5 * (p(2) - p(0)).cross(p(3) - p(1));
}

inline Point centre(const Mesh& mesh, const Face& face) {
  Point c = Point::Zero();
  for (const NodeId n : face.nodes) c += point(mesh.nodes[std::size_t(n)]);
  return c / 4;
}

}  // namespace calomel::hexahedron
