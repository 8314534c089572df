#include <cmath>
#include <map>
#include <numbers>

#include "forward/mesh/make_mesh.hpp"
#include "forward/mesh/section.hpp"

namespace calomel {
namespace {

/// A quarter disc (a, b >= 0) of radius 1 as a butterfly: a core with corners (0,0), (0.56,0), (0.5,0.5), (0,0.56) of n x n
/// quadrilaterals, and two shells of n x m between it and the circle. The polygon's area is that of the disc.
Section quarter_disc(int n, int m) {
  const double segment = std::numbers::pi / 2 / (2 * n), radius = std::sqrt(segment / std::sin(segment));
  Section s;
  std::map<std::pair<int, int>, NodeId> number;
  // (i, j) in [0, n]^2 is the core; i in (n, n+m], j in [0, n] the shell about the a axis; the other way round that about b.
  const auto at = [&](int i, int j) -> Eigen::Vector2d {
    if (i > n && j <= n) {
      const double u = double(j) / n, angle = u * std::numbers::pi / 4, out = double(i - n) / m;
      const Eigen::Vector2d core(0.56 - 0.06 * u, 0.5 * u), rim(radius * std::cos(angle), radius * std::sin(angle));
      return (1 - out) * core + out * rim;
    }
    const double u = double(i) / n, v = double(j) / n;
    return {0.56 * u - 0.06 * u * v, 0.56 * v - 0.06 * u * v};
  };
  const auto node = [&](int i, int j) {
    const auto [place, fresh] = number.try_emplace({i, j}, NodeId(s.points.size()));
    if (fresh) s.points.push_back(i <= n && j > n ? Eigen::Vector2d(at(j, i).reverse()) : at(i, j));
    return place->second;
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) s.quads.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
  // The diagonal ray belongs to both shells: (n + k, n) and (n, n + k) are one point.
  for (int k = 1; k <= m; ++k) number[{n, n + k}] = node(n + k, n);
  for (int k = n; k < n + m; ++k)
    for (int j = 0; j < n; ++j) {
      s.quads.push_back({node(k, j), node(k + 1, j), node(k + 1, j + 1), node(k, j + 1)});
      s.quads.push_back({node(j, k), node(j + 1, k), node(j + 1, k + 1), node(j, k + 1)});
    }
  s.region.assign(s.quads.size(), Region::steel);
  return s;
}

/// The whole disc from four reflections of the quarter; points on an axis are shared.
Section reflected(const Section& quarter) {
  Section s;
  std::map<std::tuple<NodeId, int, int>, NodeId> number;
  for (const int sa : {1, -1})
    for (const int sb : {1, -1})
      for (const auto& quad : quarter.quads) {
        std::array<NodeId, 4> q;
        for (std::size_t k = 0; k < 4; ++k) {
          const auto& p = quarter.points[std::size_t(quad[k])];
          const int a = p.x() < 1e-12 ? 0 : sa, b = p.y() < 1e-12 ? 0 : sb;
          const auto [place, fresh] = number.try_emplace({quad[k], a, b}, NodeId(s.points.size()));
          if (fresh) s.points.emplace_back(a * p.x(), b * p.y());
          q[k] = place->second;
        }
        s.quads.push_back(q);
      }
  s.region.assign(s.quads.size(), Region::steel);
  return s;
}

}  // namespace

Mesh make_bar(const GeometryOptions& options) {
  options.validate();
  const GeometryOptions g = options.resolved();
  const double R = *g.radius, length = *g.length;
  const auto n = bar_divisions(g);
  Section section = quarter_disc(int(n.core), int(n.shell));
  for (auto& p : section.points) {
    for (int k = 0; k < 2; ++k)
      if (p[k] < 1e-12) p[k] = 0;
    p *= R;
  }
  if (!g.quarter) section = reflected(section);
  LayeredLine x(0);
  x.add(length, int(n.along), Region::steel);

  AssemblyOptions assembly;
  if (g.quarter) assembly.mirrors = {{.axis = 1}, {.axis = 2}};
  assembly.boundary = [&](const hexahedron::Point& centre, const hexahedron::Point& normal) {
    if (normal.x() < -0.5) return BoundaryKind::loaded;
    if (normal.x() > 0.5) return BoundaryKind::free_end;
    if (g.quarter && normal.y() < -0.5 && centre.y() < 1e-9 * R) return BoundaryKind::symmetry_y;
    if (g.quarter && normal.z() < -0.5 && centre.z() < 1e-9 * R) return BoundaryKind::symmetry_z;
    return BoundaryKind::outer;
  };
  return assemble_mesh(extrude(section, x, [](double a, double b, double c) { return Vec3{c, a, b}; }), assembly);
}

}  // namespace calomel
