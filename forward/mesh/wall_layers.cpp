#include "forward/mesh/wall_layers.hpp"

namespace calomel {

WallLayers least_wall_layers(std::span<const Region> region, std::span<const FaceId> match, const std::vector<bool>& symmetric) {
  const auto steel = [&](FaceId f) { return region[std::size_t(element_of(f))] == Region::steel; };
  WallLayers least;
  for (FaceId start = 0; start < FaceId(match.size()); ++start) {
    const FaceId before = match[std::size_t(start)];
    if (!steel(start) || symmetric[std::size_t(start)] || (before != no_face && steel(before))) continue;
    const int enough = least.elements > 0 ? least.elements : int(region.size());
    int count = 1;
    for (FaceId f = start; count < enough; ++count) {
      const FaceId behind = f ^ 1, next = match[std::size_t(behind)];  // 6 is even: the opposite side of the same element
      if (next == no_face || !steel(next)) {
        if (next == no_face && symmetric[std::size_t(behind)]) count *= 2;
        break;
      }
      f = next;
    }
    if (least.elements == 0 || count < least.elements) least = {count, element_of(start)};
  }
  return least;
}

}  // namespace calomel
