#pragma once
/// Plane strain with one element across: every node of the far face moves as its partner on the near one, so that half of the nodes determine all.
#include <array>
#include <cstdint>
#include <vector>

#include "forward/mesh/mesh.hpp"

namespace calomel {

struct PlanePairs {
  std::vector<NodeId> leader;        ///< per mesh node: itself on the near face, its partner there on the far one; empty: the mesh is not of this kind
  std::vector<std::uint8_t> across;  ///< per element: which of its own axes (0, 1, 2: xi, eta, zeta) runs across
  explicit operator bool() const { return !leader.empty(); }
  /// The node that moves as this one.
  [[nodiscard]] NodeId of(NodeId n) const { return leader.empty() ? n : leader[std::size_t(n)]; }
};

/// The pairs of a mesh of plane strain (`Mesh::plane_strain`), or none: where partners do not lie straight across y from each other (to 1e-9 of the distance
/// between them), do not have the same fixed directions, y among them, or a node would have two partners.
[[nodiscard]] PlanePairs plane_pairs(const Mesh& mesh);

/// Four corners of an element on one side of the axis across, at (-1,-1), (1,-1), (-1,1), (1,1) of the other two in their order.
[[nodiscard]] std::array<std::uint8_t, 4> plane_corners(std::uint8_t across);

}  // namespace calomel
