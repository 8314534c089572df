#pragma once
/// A round bar expands where it is pressed, and that motion across has inertia: waves disperse as the first longitudinal mode of Pochhammer and Chree has it,
/// exact for a homogeneous elastic bar. Off: Poisson's ratio 0.
#include "forward/line/line_mechanism.hpp"

namespace calomel {

LineMechanismEntry lateral_inertia();

}  // namespace calomel
