#pragma once
/// A quarter of a disc of mercury within a ring of steel: the section of rings and pipes.
#include <map>
#include <numbers>

#include "forward/mesh/section.hpp"

namespace calomel::testing {

/// A butterfly of the mercury, (a, b) >= 0: a core of n x n quadrilaterals with corners (0, 0), (0.56, 0), (0.5, 0.5), (0, 0.56) radii, two shells of
/// n x m about it, and `through` layers of steel. Wall nodes lie on circles; areas of all polygons are smaller than the circles' by the same factor.
inline Section filled_ring(int n, int m, int through, double radius, double h) {
  Section s;
  std::map<std::pair<int, int>, NodeId> number;
  const auto at = [&](int i, int j) -> Eigen::Vector2d {  // i >= j or both within the core
    if (i <= n) {
      const double u = double(i) / n, v = double(j) / n;
      return radius * Eigen::Vector2d(0.56 * u - 0.06 * u * v, 0.56 * v - 0.06 * u * v);
    }
    const double u = double(j) / n, angle = u * std::numbers::pi / 4;
    const Eigen::Vector2d rim(std::cos(angle), std::sin(angle)), core(0.56 - 0.06 * u, 0.5 * u);
    if (i > n + m) return (radius + h * (i - n - m) / through) * rim;
    const double out = double(i - n) / m;
    return radius * ((1 - out) * core + out * rim);
  };
  const auto node = [&](int i, int j) {
    if (i == n && j > n) std::swap(i, j);  // the diagonal ray belongs to both shells
    const auto [place, fresh] = number.try_emplace({i, j}, NodeId(s.points.size()));
    if (fresh) {
      Eigen::Vector2d p = j > n ? Eigen::Vector2d(at(j, i).reverse()) : at(i, j);
      for (int k = 0; k < 2; ++k)
        if (p[k] < 1e-12 * radius) p[k] = 0;
      s.points.push_back(p);
    }
    return place->second;
  };
  const auto quad = [&](int i, int j, int di, int dj, Region region) {
    s.quads.push_back({node(i, j), node(i + di, j), node(i + di, j + dj), node(i, j + dj)});
    s.region.push_back(region);
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) quad(i, j, 1, 1, Region::mercury);
  for (int k = n; k < n + m + through; ++k)
    for (int j = 0; j < n; ++j) {
      const Region region = k < n + m ? Region::mercury : Region::steel;
      quad(k, j, 1, 1, region);
      quad(j, k, 1, 1, region);
    }
  return s;
}

/// Faces of a quarter about the x axis between x = 0 and `end`: its plane sides are symmetric; the ends are left to the caller.
inline std::function<BoundaryKind(const hexahedron::Point&, const hexahedron::Point&)> symmetric_quarter(double end) {
  return [end](const hexahedron::Point& centre, const hexahedron::Point& normal) {
    if (centre.x() < 1e-9 || centre.x() > end - 1e-9) return BoundaryKind::free_end;
    if (normal.y() < -0.999 && centre.y() < 1e-9) return BoundaryKind::symmetry_y;
    if (normal.z() < -0.999 && centre.z() < 1e-9) return BoundaryKind::symmetry_z;
    return BoundaryKind::outer;
  };
}

}  // namespace calomel::testing
