#pragma once
#include <optional>
#include <string>

#include "base/options.hpp"

namespace calomel {

/// Wall thicknesses [m] that differ from `wall`.
struct WallOptions {
  std::optional<double> front, rear, side, top, bottom;
  template <class V>
  void visit(V& v) {
    v("front", front, {.unit = "m", .range = above(0), .doc = "thickness of the front wall"});
    v("rear", rear, {.unit = "m", .range = above(0), .doc = "thickness of the rear wall (unused when the rear is non-reflecting)"});
    v("side", side, {.unit = "m", .range = above(0), .doc = "thickness of the side walls"});
    v("top", top, {.unit = "m", .range = above(0), .doc = "thickness of the top wall"});
    v("bottom", bottom, {.unit = "m", .range = above(0), .doc = "thickness of the bottom wall"});
  }
};

}  // namespace calomel
