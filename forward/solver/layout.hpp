#pragma once
/// The order of work in a step: elements in blocks that fit the cache, nodes numbered by first touch, and the nodes that
/// several blocks or a boundary condition share, whose forces are summed in a fixed order. Nothing here depends on the
/// number of threads, so results do not either.
#include <array>
#include <cstdint>
#include <vector>

#include "forward/mesh/mesh.hpp"
#include "forward/solver/plane_pairs.hpp"

namespace calomel {

/// A run of nodes in solver order with the same fixed directions.
struct NodeRange {
  std::int32_t begin, end;
  std::uint8_t fixed;
};

struct Block {
  bool liquid = false;
  bool parallelepiped = false;         ///< all its elements are
  std::vector<std::int32_t> elements;  ///< mesh element ids
  std::int32_t first_node = 0;         ///< interior nodes are [first_node, first_node + interior) in solver order
  std::int32_t interior = 0;
  std::vector<NodeRange> ranges;            ///< interior nodes by fixed directions
  std::vector<std::int32_t> shared;         ///< solver ids of the other nodes; local id = interior + position
  std::vector<std::uint16_t> connectivity;  ///< (elements, 8) local ids; of nodes that move as one, the same
  std::size_t outbox = 0;                   ///< where its forces on shared nodes go
};

/// A node (or a slip pair) that needs more than the sum of its element forces.
struct SpecialNode {
  std::int32_t node = -1;     ///< solver id; the mercury node of a pair
  std::int32_t partner = -1;  ///< the steel node of a slip pair, or -1
  int normals = 0;
  std::array<Vec3, 3> normal{};  ///< directions in which the pair moves together
  std::int32_t rear = -1;        ///< row in Layout::rear, or -1
  std::int32_t loaded = -1;      ///< row in Layout::loaded, or -1
};

/// A node with a share of a boundary face.
struct BoundaryNode {
  std::int32_t node;  ///< mesh id
  Vec3 area;          ///< int N_I n dA, out of the material [m^2]
};

struct Layout {
  std::vector<Block> blocks;
  PlanePairs pairs;                     ///< mesh nodes that share a solver node; of most meshes none
  std::vector<std::int32_t> to_solver;  ///< mesh node -> solver node
  std::int32_t nodes = 0;
  std::int32_t first_shared = 0;    ///< solver ids from here on are shared
  std::vector<std::int32_t> plain;  ///< shared nodes without a special rule
  std::vector<SpecialNode> special;
  std::vector<std::uint8_t> fixed;        ///< by solver id
  std::vector<std::size_t> outbox_begin;  ///< (shared nodes + 1): rows of `outbox_rows` of each shared node
  std::vector<std::size_t> outbox_rows;   ///< positions in the outbox, in block order
  std::size_t outbox_size = 0;
  std::size_t first_slow_block = 0;          ///< blocks from here on take long steps; their number when there are none
  std::size_t first_slow_plain = 0;          ///< rows of `plain` from here on belong to slow blocks alone
  std::vector<std::size_t> outbox_fast_end;  ///< per shared node: one past the rows of fast blocks
  std::vector<BoundaryNode> rear, loaded;
};

/// `block_size`: elements per block. `slow`: per element, whether it takes long steps (subcycles.hpp); empty: none does. Blocks of fast elements come first.
/// `pairs`: nodes that are to share a solver node.
Layout make_layout(const Mesh& mesh, const std::vector<std::uint8_t>& parallelepiped, std::size_t block_size, const std::vector<std::uint8_t>& slow = {},
                   PlanePairs pairs = {});

/// What a block costs beside others: general elements of liquid count 1 each (`bench_solver --kinds`). `own_law`: the liquid's is not Riemer's.
double block_cost(const Block& block, bool own_law);

/// The same of the nodes that blocks share or that have a rule, of slow blocks alone or of the others.
double node_cost(const Layout& layout, bool slow);

/// Shares of the faces' area vectors at their nodes, exact for bilinear faces; nodes that move as one have one share, at their leader.
std::vector<BoundaryNode> boundary_nodes(const Mesh& mesh, const std::vector<Face>& faces, const PlanePairs& pairs = {});

}  // namespace calomel
