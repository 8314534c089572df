#pragma once
/// Numbers that are none.
#include <limits>

namespace calomel {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();  ///< stands for one that there is none of: no recording there, a run that failed

}  // namespace calomel
