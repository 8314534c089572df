#include "apps/report/data/surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace calomel {

ReportSurface report_surface(const Mesh& mesh, const std::vector<Face>& faces) {
  ReportSurface surface;
  std::vector<std::int32_t> number(mesh.nodes.size(), -1);
  for (const auto& face : faces) {
    auto& quad = surface.quads.emplace_back();
    for (int i = 0; i < 4; ++i) {
      auto& n = number[std::size_t(face.nodes[i])];
      if (n < 0) {
        n = std::int32_t(surface.vertices.size());
        surface.vertices.push_back(mesh.nodes[std::size_t(face.nodes[i])]);
      }
      quad[i] = n;
    }
  }
  return surface;
}

namespace {
/// Vertex clustering with cells of size h. The vertex nearest to the extremes of the box represents its cell, so flat sides remain flat and outer edges remain
/// in place.
ReportSurface clustered(const ReportSurface& surface, double h, const Vec3& low, const Vec3& high) {
  using Cell = std::array<std::int64_t, 3>;
  const auto edge_distance = [&](const Vec3& v) {
    double d = 0;
    for (int i = 0; i < 3; ++i) d += std::min(v[i] - low[i], high[i] - v[i]);
    return d;
  };
  std::map<Cell, std::int32_t> cells;
  ReportSurface thin;
  std::vector<std::int32_t> to(surface.vertices.size());
  for (std::size_t i = 0; i < surface.vertices.size(); ++i) {
    const auto& v = surface.vertices[i];
    Cell cell;
    for (int k = 0; k < 3; ++k) cell[k] = std::llround((v[k] - low[k]) / h);
    const auto [at, fresh] = cells.try_emplace(cell, std::int32_t(thin.vertices.size()));
    if (fresh)
      thin.vertices.push_back(v);
    else if (auto& w = thin.vertices[std::size_t(at->second)]; edge_distance(v) < edge_distance(w))
      w = v;
    to[i] = at->second;
  }
  std::set<std::array<std::int32_t, 4>> seen;
  for (const auto& quad : surface.quads) {
    std::array<std::int32_t, 4> q;
    for (int i = 0; i < 4; ++i) q[i] = to[std::size_t(quad[i])];
    auto sorted = q;
    std::sort(sorted.begin(), sorted.end());
    const auto corners = std::unique(sorted.begin(), sorted.end()) - sorted.begin();
    if (corners < 3) continue;  // collapsed to an edge or a point
    sorted = q;
    std::sort(sorted.begin(), sorted.end());
    if (seen.insert(sorted).second) thin.quads.push_back(q);
  }
  return thin;
}
}  // namespace

ReportSurface thinned(const ReportSurface& surface, std::size_t most_quads) {
  if (surface.quads.size() <= most_quads || surface.vertices.empty()) return surface;
  Vec3 low = surface.vertices.front();
  Vec3 high = low;
  for (const auto& v : surface.vertices)
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], v[i]);
      high[i] = std::max(high[i], v[i]);
    }
  const double size = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  // A closed surface has at most about 6 n^2 cells at n cells along its longest side. The cells grow until the surface fits.
  double h = size / std::sqrt(double(most_quads));
  ReportSurface thin = clustered(surface, h, low, high);
  while (thin.quads.size() > most_quads) thin = clustered(surface, h *= 1.3, low, high);
  return thin;
}

}  // namespace calomel
