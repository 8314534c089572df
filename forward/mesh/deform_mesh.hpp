#pragma once
/// Meshes of slightly other shape and the same topology: jitter for the repeatability floor, thinned walls, any nodal
/// displacement.
#include <limits>
#include <span>
#include <string>

#include "base/random.hpp"
#include "forward/mesh/mesh.hpp"

namespace calomel {

/// Moves every node by displacement (nodes, 3) [m]; the mercury node of a slip pair goes with its steel partner. Slip
/// normals, quality and liquid_element_size follow.
/// Errors: NumericsError naming the element that this would invert; the mesh is then unchanged.
void displace_nodes(Mesh& mesh, std::span<const Vec3> displacement);

/// The mesh with nodes moved at random, each coordinate evenly within +- fraction of the shortest edge at the node.
/// Nodes of boundaries and interfaces only slide within the planes that meet there, so the shape does not change; in
/// plane strain both y faces move alike. Where an element would come out worse than a scaled Jacobian of 0.15 (or half
/// of what it was), the moves of its nodes are halved until it does not. fraction in [0, 0.45].
/// Draws 3 numbers a node from `random`.
[[nodiscard]] Mesh jittered(Mesh mesh, double fraction, RandomStream& random);

/// Part of a wall to be thinned from inside.
struct WallThinning {
  std::string wall;                                         ///< front, rear, side, top or bottom: where the outer normal's largest component points
  double fraction = 0;                                      ///< of the thickness, in [0, 0.9]
  double begin = -std::numeric_limits<double>::infinity();  ///< along x; along z for front and rear [m]
  double end = std::numeric_limits<double>::infinity();
};

/// Moves the wetted side of a wall outwards by `fraction` of the thickness; the outer side, and gauges on it, remain. The
/// mercury follows, less and less towards the middle of what faces the wall. A node represents the wall half way to its neighbours along it, and moves by the
/// share of that which lies between begin and end: what is thinned depends on both without steps. Errors: InputError on "wall" when the mesh has no such wall
/// between steel and mercury, on "fraction" out of range.
void thin_wall(Mesh& mesh, const WallThinning& thinning);

struct PairAtWall {
  std::size_t pair = 0;  ///< row of Mesh::slip
  double share = 1;      ///< of the part of the wall that it represents, half way to its neighbours, that lies between begin and end, in (0, 1]
};

/// Of the wetted side of a wall between begin and end, in ascending order (the fraction does not matter); of wall "all" on every wetted face, those of plates
/// inside as well. Empty where the mesh has no such wall between mercury and outside, or nothing of it between begin and end.
[[nodiscard]] std::vector<PairAtWall> pairs_at_wall(const Mesh& mesh, const WallThinning& stretch);

}  // namespace calomel
