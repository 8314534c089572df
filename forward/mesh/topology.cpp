#include "forward/mesh/topology.hpp"

#include <algorithm>
#include <numeric>

#include "base/errors.hpp"
#include "forward/mesh/hexahedron.hpp"

namespace calomel {

std::array<NodeId, 4> face_nodes(std::span<const std::array<NodeId, 8>> elements, FaceId face) {
  const auto& e = elements[std::size_t(element_of(face))];
  const auto& f = hexahedron::faces[std::size_t(side_of(face))];
  return {e[std::size_t(f[0])], e[std::size_t(f[1])], e[std::size_t(f[2])], e[std::size_t(f[3])]};
}

FaceId face_id(std::span<const std::array<NodeId, 8>> elements, const Face& face) {
  for (FaceId f = 6 * face.element; f < 6 * face.element + 6; ++f) {
    const auto nodes = face_nodes(elements, f);
    if (std::is_permutation(nodes.begin(), nodes.end(), face.nodes.begin())) return f;
  }
  expect(false, "a face belongs to its element");
  return no_face;
}

std::vector<FaceId> matching_faces(std::span<const std::array<NodeId, 8>> elements, std::size_t nodes, const std::function<void(FaceId, FaceId)>& crowded) {
  expect(elements.size() < std::size_t(1) << 28, "face numbers fit into 32 bits");
  const auto n = FaceId(6 * elements.size());
  const auto sorted = [&](FaceId f) {
    auto s = face_nodes(elements, f);
    std::sort(s.begin(), s.end());
    return s;
  };
  // Faces in buckets of their least node: a handful in each.
  std::vector<std::int32_t> begin(nodes + 1, 0);
  std::vector<FaceId> bucket(static_cast<std::size_t>(n));
  const auto least = [&](FaceId f) {
    const auto s = face_nodes(elements, f);
    return std::size_t(std::min(std::min(s[0], s[1]), std::min(s[2], s[3])));
  };
  for (FaceId f = 0; f < n; ++f) ++begin[least(f) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::int32_t> next(begin.begin(), begin.end() - 1);
  for (FaceId f = 0; f < n; ++f) bucket[std::size_t(next[least(f)]++)] = f;
  next = {};

  std::vector<FaceId> match(std::size_t(n), no_face);
  for (std::size_t node = 0; node < nodes; ++node)
    for (auto i = begin[node]; i < begin[node + 1]; ++i) {
      const FaceId f = bucket[std::size_t(i)];
      const auto own = sorted(f);
      for (auto j = i + 1; j < begin[node + 1]; ++j) {
        const FaceId g = bucket[std::size_t(j)];
        if (sorted(g) != own) continue;
        const bool alone = match[std::size_t(f)] == no_face && match[std::size_t(g)] == no_face;
        expect(alone || crowded, "a face belongs to at most two elements");
        if (!alone) crowded(f, g);
        match[std::size_t(f)] = g;
        match[std::size_t(g)] = f;
      }
    }
  return match;
}

std::vector<std::array<NodeId, 8>> tied_elements(const Mesh& mesh) {
  std::vector<NodeId> partner(mesh.nodes.size());
  std::iota(partner.begin(), partner.end(), NodeId{0});
  for (const auto& pair : mesh.slip) partner[std::size_t(pair.mercury)] = pair.steel;
  auto elements = mesh.elements;
  for (auto& e : elements)
    for (auto& node : e) node = partner[std::size_t(node)];
  return elements;
}

std::vector<std::int32_t> morton_order(std::span<const Vec3> centres) {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (const auto& c : centres)
    for (std::size_t k = 0; k < 3; ++k) low[k] = std::min(low[k], c[k]), high[k] = std::max(high[k], c[k]);
  const double extent = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2], 1e-300});
  // Spreads 21 bits to every third place (Morton 1966).
  const auto interleave = [](std::uint64_t x) {
    x &= 0x1fffff;
    x = (x | x << 32) & 0x1f00000000ffff;
    x = (x | x << 16) & 0x1f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    return (x | x << 2) & 0x1249249249249249;
  };
  std::vector<std::pair<std::uint64_t, std::int32_t>> keyed(centres.size());
  for (std::size_t i = 0; i < centres.size(); ++i) {
    std::uint64_t key = 0;
    for (std::size_t k = 0; k < 3; ++k) key |= interleave(std::uint64_t((centres[i][k] - low[k]) / extent * 0x1fffff)) << k;
    keyed[i] = {key, std::int32_t(i)};
  }
  std::sort(keyed.begin(), keyed.end());
  std::vector<std::int32_t> order(centres.size());
  for (std::size_t i = 0; i < centres.size(); ++i) order[i] = keyed[i].second;
  return order;
}

}  // namespace calomel
