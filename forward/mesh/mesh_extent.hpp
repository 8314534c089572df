#pragma once
/// How far a mesh reaches.
#include <algorithm>
#include <utility>

#include "forward/mesh/mesh.hpp"

namespace calomel {

/// Least and greatest coordinate of the nodes along axis c [m].
inline std::pair<double, double> extent(const Mesh& mesh, std::size_t c) {
  const auto [low, high] = std::minmax_element(mesh.nodes.begin(), mesh.nodes.end(), [c](const Vec3& a, const Vec3& b) { return a[c] < b[c]; });
  return {(*low)[c], (*high)[c]};
}

}  // namespace calomel
