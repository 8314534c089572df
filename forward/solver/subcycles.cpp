#include "forward/solver/subcycles.hpp"

#include <algorithm>

#include "forward/solver/layout.hpp"

namespace calomel {

std::vector<std::uint8_t> slow_elements(const Mesh& mesh, int buffer) {
  const std::size_t count = mesh.elements.size();
  std::vector<std::uint8_t> slow(count, 1), near(mesh.nodes.size(), 0);
  const auto take = [&](std::size_t e) {
    slow[e] = 0;
    for (const NodeId n : mesh.elements[e]) near[std::size_t(n)] = 1;
  };
  for (std::size_t e = 0; e < count; ++e)
    if (mesh.region[e] != Region::mercury) take(e);
  for (const auto& pair : mesh.slip) near[std::size_t(pair.mercury)] = 1;
  for (const auto* faces : {&mesh.rear, &mesh.loaded})
    for (const auto& face : *faces)
      for (const NodeId n : face.nodes) near[std::size_t(n)] = 1;
  for (int layer = 0; layer < buffer; ++layer) {
    std::vector<std::size_t> next;
    for (std::size_t e = 0; e < count; ++e)
      if (slow[e] && std::any_of(mesh.elements[e].begin(), mesh.elements[e].end(), [&](NodeId n) { return near[std::size_t(n)] != 0; })) next.push_back(e);
    for (const std::size_t e : next) take(e);
  }
  return slow;
}

Stepping cheapest_stepping(const Layout& layout, bool own_law, int least, int least_slow, int most) {
  double fast = node_cost(layout, false), slow = node_cost(layout, true);
  for (std::size_t b = 0; b < layout.blocks.size(); ++b) (b < layout.first_slow_block ? fast : slow) += block_cost(layout.blocks[b], own_law);
  Stepping best{.per_output = least};
  double least_cost = least * (fast + slow);
  for (int m = 2; m <= most && slow > 0; ++m) {
    const int periods = std::max((least + m - 1) / m, least_slow);
    const double cost = periods * (m * fast + slow);
    if (cost < least_cost * (1 - 1e-9)) {
      least_cost = cost;
      best = {.per_output = periods * m, .subcycles = m, .work = (m * fast + slow) / (m * (fast + slow))};
    }
  }
  return best;
}

}  // namespace calomel
