#pragma once
/// The number that stands for one that there is none of: no recording there, a run that failed.
#include <limits>

namespace calomel {

inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();

}  // namespace calomel
