#pragma once
/// Damping of the steel, C = mass M + stiffness K (Rayleigh): the ratio of a mode of angular frequency w is zeta = (mass / w + stiffness w) / 2.
/// Off: both 0 (physics.md section 3).
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

MechanismEntry structural_damping();

}  // namespace calomel
