#pragma once
/// JSON from strangers: what is nested too deeply is refused before anything is made of it, because values are copied and written by recursion.
#include <string>

#include "base/json.hpp"

namespace calomel {

inline constexpr int deepest_json = 64;  ///< brackets within one another; UM-Bridge itself needs four

/// The value of a text; discarded where it is no JSON (NaN and Infinity are none) or deeper than that.
[[nodiscard]] Json shallow_json(const std::string& text);

}  // namespace calomel
