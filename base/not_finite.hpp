#pragma once
/// Numbers that are none.
#include <limits>

namespace calomel {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();  ///< represents a missing value: no recording there, or a failed run

}  // namespace calomel
