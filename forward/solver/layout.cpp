#include "forward/solver/layout.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "base/errors.hpp"

namespace calomel {

namespace {

/// Interleaves the bits of three 21-bit coordinates (Morton 1966).
std::uint64_t morton(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  const auto interleave = [](std::uint64_t v) {
    v &= 0x1fffff;
    v = (v | v << 32) & 0x1f00000000ffffull;
    v = (v | v << 16) & 0x1f0000ff0000ffull;
    v = (v | v << 8) & 0x100f00f00f00f00full;
    v = (v | v << 4) & 0x10c30c30c30c30c3ull;
    v = (v | v << 2) & 0x1249249249249249ull;
    return v;
  };
  return interleave(x) | interleave(y) << 1 | interleave(z) << 2;
}

std::vector<std::int32_t> element_order(const Mesh& mesh, const std::vector<std::uint8_t>& parallelepiped, const std::vector<std::uint8_t>& slow) {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (const auto& x : mesh.nodes)
    for (std::size_t c = 0; c < 3; ++c) low[c] = std::min(low[c], x[c]), high[c] = std::max(high[c], x[c]);
  const double extent = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  const double scale = double((1 << 20) - 1) / extent;
  std::vector<std::uint64_t> key(mesh.elements.size());
  for (std::size_t e = 0; e < key.size(); ++e) {
    Vec3 centre{};
    for (const NodeId n : mesh.elements[e])
      for (std::size_t c = 0; c < 3; ++c) centre[c] += mesh.nodes[std::size_t(n)][c] / 8;
    std::array<std::uint32_t, 3> q{};
    for (std::size_t c = 0; c < 3; ++c) q[c] = std::uint32_t((centre[c] - low[c]) * scale);
    const std::uint64_t kind = (!slow.empty() && slow[e] ? 4 : 0) + (mesh.region[e] == Region::mercury ? 2 : 0) + (parallelepiped[e] ? 1 : 0);
    key[e] = kind << 61 | morton(q[0], q[1], q[2]);
  }
  std::vector<std::int32_t> order(key.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return key[std::size_t(a)] < key[std::size_t(b)]; });
  return order;
}

}  // namespace

std::vector<BoundaryNode> boundary_nodes(const Mesh& mesh, const std::vector<Face>& faces, const PlanePairs& pairs) {
  std::map<NodeId, Vec3> area;
  const double gauss = 1 / std::sqrt(3.0);
  for (const auto& face : faces) {
    // Corners counter-clockwise at (-1,-1), (1,-1), (1,1), (-1,1).
    static constexpr std::array<double, 4> sx{-1, 1, 1, -1}, sy{-1, -1, 1, 1};
    for (int point = 0; point < 4; ++point) {
      const double xi = point & 1 ? gauss : -gauss, eta = point & 2 ? gauss : -gauss;
      Vec3 t1{}, t2{};
      std::array<double, 4> n{};
      for (std::size_t k = 0; k < 4; ++k) {
        const auto& x = mesh.nodes[std::size_t(face.nodes[k])];
        n[k] = 0.25 * (1 + sx[k] * xi) * (1 + sy[k] * eta);
        for (std::size_t c = 0; c < 3; ++c) t1[c] += 0.25 * sx[k] * (1 + sy[k] * eta) * x[c], t2[c] += 0.25 * sy[k] * (1 + sx[k] * xi) * x[c];
      }
      const Vec3 normal{t1[1] * t2[2] - t1[2] * t2[1], t1[2] * t2[0] - t1[0] * t2[2], t1[0] * t2[1] - t1[1] * t2[0]};
      for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t c = 0; c < 3; ++c) area[pairs.of(face.nodes[k])][c] += n[k] * normal[c];
    }
  }
  std::vector<BoundaryNode> out;
  for (const auto& [node, a] : area) out.push_back({node, a});
  return out;
}

double block_cost(const Block& block, bool own_law) {
  const double element = block.liquid ? (block.parallelepiped ? 0.75 : 1.0) + (own_law ? 3.0 : 0.0) : block.parallelepiped ? 1.6 : 1.9;
  return double(block.elements.size()) * element;
}

double node_cost(const Layout& layout, bool slow) {
  constexpr double shared = 0.25, ruled = 0.7;
  const std::size_t plain = slow ? layout.plain.size() - layout.first_slow_plain : layout.first_slow_plain;
  return shared * double(plain) + (slow ? 0 : ruled * double(layout.special.size()));
}

Layout make_layout(const Mesh& mesh, const std::vector<std::uint8_t>& parallelepiped, std::size_t block_size, const std::vector<std::uint8_t>& slow,
                   PlanePairs pairs) {
  expect(block_size >= 8 && block_size <= 8192, "a block holds 8 to 8192 elements");
  Layout layout;
  layout.pairs = std::move(pairs);
  const auto leader = [&](NodeId n) { return std::size_t(layout.pairs.of(n)); };
  const auto order = element_order(mesh, parallelepiped, slow);
  const auto is_slow = [&](std::int32_t e) { return !slow.empty() && slow[std::size_t(e)]; };
  const auto kind = [&](std::int32_t e) { return std::tuple(is_slow(e), mesh.region[std::size_t(e)], parallelepiped[std::size_t(e)]); };
  for (std::size_t i = 0; i < order.size();) {
    Block block;
    block.liquid = mesh.region[std::size_t(order[i])] == Region::mercury;
    block.parallelepiped = parallelepiped[std::size_t(order[i])];
    const auto first = kind(order[i]);
    while (i < order.size() && block.elements.size() < block_size && kind(order[i]) == first) block.elements.push_back(order[i++]);
    if (!is_slow(block.elements[0])) layout.first_slow_block = layout.blocks.size() + 1;
    layout.blocks.push_back(std::move(block));
  }

  // A node is shared when two blocks touch it or a rule beyond its element forces applies.
  constexpr std::int32_t untouched = -1, shared = -2;
  std::vector<std::int32_t> owner(mesh.nodes.size(), untouched);
  layout.rear = boundary_nodes(mesh, mesh.rear, layout.pairs);
  layout.loaded = boundary_nodes(mesh, mesh.loaded, layout.pairs);
  for (const auto& pair : mesh.slip) owner[leader(pair.steel)] = owner[leader(pair.mercury)] = shared;
  for (const auto& n : layout.rear) owner[std::size_t(n.node)] = shared;
  for (const auto& n : layout.loaded) owner[std::size_t(n.node)] = shared;
  for (std::size_t b = 0; b < layout.blocks.size(); ++b)
    for (const auto e : layout.blocks[b].elements)
      for (const NodeId n : mesh.elements[std::size_t(e)]) {
        auto& o = owner[leader(n)];
        o = o == untouched ? std::int32_t(b) : o == std::int32_t(b) ? o : shared;
      }

  // Interior nodes block by block, by fixed directions and then first touch; then the shared ones by first touch.
  layout.to_solver.assign(mesh.nodes.size(), -1);
  for (std::size_t b = 0; b < layout.blocks.size(); ++b) {
    Block& block = layout.blocks[b];
    block.first_node = layout.nodes;
    std::vector<NodeId> mine;
    for (const auto e : block.elements)
      for (const NodeId n : mesh.elements[std::size_t(e)])
        if (owner[leader(n)] == std::int32_t(b)) {
          mine.push_back(NodeId(leader(n)));
          owner[leader(n)] = -3 - std::int32_t(b);
        }
    std::stable_sort(mine.begin(), mine.end(), [&](NodeId a, NodeId c) { return mesh.fixed[std::size_t(a)] < mesh.fixed[std::size_t(c)]; });
    for (const NodeId n : mine) {
      const auto bits = mesh.fixed[std::size_t(n)];
      if (block.ranges.empty() || block.ranges.back().fixed != bits) block.ranges.push_back({layout.nodes, layout.nodes, bits});
      layout.to_solver[std::size_t(n)] = layout.nodes++;
      block.ranges.back().end = layout.nodes;
    }
    block.interior = layout.nodes - block.first_node;
  }
  layout.first_shared = layout.nodes;
  for (const auto& block : layout.blocks)
    for (const auto e : block.elements)
      for (const NodeId n : mesh.elements[std::size_t(e)])
        if (layout.to_solver[leader(n)] < 0) layout.to_solver[leader(n)] = layout.nodes++;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    layout.to_solver[n] = layout.to_solver[leader(NodeId(n))];
    expect(layout.to_solver[n] >= 0, "every node belongs to an element");
  }

  // Local connectivity and the outbox.
  std::vector<std::vector<std::size_t>> rows(std::size_t(layout.nodes - layout.first_shared));
  std::vector<std::int32_t> local(std::size_t(layout.nodes), -1);
  for (auto& block : layout.blocks) {
    block.outbox = layout.outbox_size;
    for (const auto e : block.elements)
      for (const NodeId n : mesh.elements[std::size_t(e)]) {
        const std::int32_t s = layout.to_solver[std::size_t(n)];
        if (s < layout.first_shared) {
          block.connectivity.push_back(std::uint16_t(s - block.first_node));
          continue;
        }
        auto& l = local[std::size_t(s)];
        if (l < 0) {
          l = block.interior + std::int32_t(block.shared.size());
          rows[std::size_t(s - layout.first_shared)].push_back(layout.outbox_size + block.shared.size());
          block.shared.push_back(s);
        }
        expect(l < 65536, "a block's nodes fit 16 bits");
        block.connectivity.push_back(std::uint16_t(l));
      }
    for (const auto s : block.shared) local[std::size_t(s)] = -1;
    layout.outbox_size += block.shared.size();
  }
  const std::size_t slow_outbox = layout.first_slow_block < layout.blocks.size() ? layout.blocks[layout.first_slow_block].outbox : layout.outbox_size;
  layout.outbox_begin.push_back(0);
  for (const auto& r : rows) {
    layout.outbox_rows.insert(layout.outbox_rows.end(), r.begin(), r.end());
    const auto slow_rows = r.end() - std::lower_bound(r.begin(), r.end(), slow_outbox);
    layout.outbox_fast_end.push_back(layout.outbox_rows.size() - std::size_t(slow_rows));
    layout.outbox_begin.push_back(layout.outbox_rows.size());
  }
  layout.fixed.resize(std::size_t(layout.nodes));
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) layout.fixed[std::size_t(layout.to_solver[n])] = mesh.fixed[n];

  // Special rules.
  std::map<std::int32_t, SpecialNode> special;  // by solver id of the leading node, so that the order is fixed
  std::vector<std::uint8_t> led(std::size_t(layout.nodes), 0);
  for (const auto& pair : mesh.slip) {
    SpecialNode s;
    s.node = layout.to_solver[std::size_t(pair.mercury)];
    s.partner = layout.to_solver[std::size_t(pair.steel)];
    s.normals = pair.count;
    s.normal = pair.normals;
    led[std::size_t(s.node)] = led[std::size_t(s.partner)] = 1;
    special[s.node] = s;
  }
  const auto attach = [&](const std::vector<BoundaryNode>& nodes, std::int32_t SpecialNode::*row) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const auto n = layout.to_solver[std::size_t(nodes[i].node)];
      SpecialNode& s = special[n];
      expect(s.node < 0 || s.node == n, "a boundary node leads its own rule");
      s.node = n;
      s.*row = std::int32_t(i);
      led[std::size_t(n)] = 1;
    }
  };
  attach(layout.rear, &SpecialNode::rear);
  attach(layout.loaded, &SpecialNode::loaded);
  for (const auto& [n, s] : special) layout.special.push_back(s);
  for (std::int32_t s = layout.first_shared; s < layout.nodes; ++s)
    if (!led[std::size_t(s)]) layout.plain.push_back(s);
  const auto slow_alone = std::stable_partition(layout.plain.begin(), layout.plain.end(), [&](std::int32_t s) {
    const std::size_t k = std::size_t(s - layout.first_shared);
    return layout.outbox_fast_end[k] > layout.outbox_begin[k];
  });
  layout.first_slow_plain = std::size_t(slow_alone - layout.plain.begin());
  return layout;
}

}  // namespace calomel
