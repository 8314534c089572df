#pragma once
/// What lies behind the rear face answers: (1 - r) p' = (1 + r) rho c v_n with p' = p - p0 there. A plane wave at normal incidence comes back with r times
/// its pressure; 1 is a rigid wall, -1 a free surface. Off: r = 0, equally heated mercury (physics.md section 3).
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

MechanismEntry rear_reflection();

}  // namespace calomel
