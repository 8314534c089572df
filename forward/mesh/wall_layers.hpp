#pragma once
/// The number of elements through the walls of a mesh.
#include <span>

#include "forward/mesh/topology.hpp"

namespace calomel {

/// A wall, counted from one of its faces.
struct WallLayers {
  int elements = 0;         ///< fewest elements of steel between two faces that are free or wetted; 0 = none was found
  std::int32_t first = -1;  ///< element at one end of that wall
};

/// Marches from every free or wetted steel face through the element to its opposite side, and on while there is steel. Faces
/// in `symmetric` are no ends of a wall: it goes on behind them as its mirror image and counts twice. Long or closed ways do
/// not matter, the fewest count.
WallLayers least_wall_layers(std::span<const Region> region, std::span<const FaceId> match, const std::vector<bool>& symmetric);

}  // namespace calomel
