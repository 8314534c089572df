#pragma once
/// Which faces of a hexahedral mesh meet.
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "forward/mesh/mesh.hpp"

namespace calomel {

/// A face as 6 * element + its number in hexahedron::faces; -1 = none.
using FaceId = std::int32_t;
inline constexpr FaceId no_face = -1;
inline std::int32_t element_of(FaceId f) { return f / 6; }
inline int side_of(FaceId f) { return f % 6; }

/// Nodes of a face, counter-clockwise seen from outside its element.
std::array<NodeId, 4> face_nodes(std::span<const std::array<NodeId, 8>> elements, FaceId face);

/// Number of a face of `elements`. Errors: contract failure when the element does not have it.
FaceId face_id(std::span<const std::array<NodeId, 8>> elements, const Face& face);

/// For every face (6 per element) the face of the other element that has the same four nodes, or no_face.
/// Time and memory are linear in the number of elements. Where three elements share a face, `crowded` is called with two
/// of their faces. Errors: contract failure where it is not given.
std::vector<FaceId> matching_faces(std::span<const std::array<NodeId, 8>> elements, std::size_t nodes, const std::function<void(FaceId, FaceId)>& crowded = {});

/// The elements of `mesh` with every mercury node of a slip pair replaced by its steel partner, so that steel and
/// mercury are connected.
std::vector<std::array<NodeId, 8>> tied_elements(const Mesh& mesh);

/// Positions of a Morton (Z-order) walk through `centres`: near in the walk is near in space.
std::vector<std::int32_t> morton_order(std::span<const Vec3> centres);

}  // namespace calomel
