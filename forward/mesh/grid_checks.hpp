#pragma once
/// What a mesh from outside must be before it is a target: sound elements, joined by the nodes that they share.
#include "forward/mesh/mesh_file.hpp"

namespace calomel {

/// Diagonal of the box around the nodes, in the unit of the nodes.
double extent(const MeshFile& mesh);

/// Leaves out the nodes that no element has; returns how many those are.
std::size_t drop_loose_nodes(MeshFile& mesh);

/// Makes one node of those nearer to each other than `distance`; returns how many went.
/// Errors: InputError on "merge_distance" when an element would lose an edge.
std::size_t merge_nodes(MeshFile& mesh, double distance);

/// Errors: InputError for the first element that names a node twice or has a corner that is turned inside out, and how many.
void expect_sound_elements(const MeshFile& mesh);

/// Errors: InputError when nodes lie within 1e-6 of the extent of each other without being one, saying how many, where and
/// between which materials; or when the elements make several pieces that share no node.
void expect_joined(const MeshFile& mesh, std::span<const Region> region);

/// matching_faces of the file's elements. Errors: InputError where three elements share a face.
std::vector<FaceId> matching_faces(const MeshFile& mesh);

}  // namespace calomel
