#pragma once
/// A wall that erosion has made thinner from inside: h -> h (1 - fraction) over a stretch. The outer face and the gauges on it remain, the mercury follows.
/// Local bending goes as 1/h^2. Off: fraction = 0 (physics.md section 3).
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

MechanismEntry wall_thinning();

}  // namespace calomel
