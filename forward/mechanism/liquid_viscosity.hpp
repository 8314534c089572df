#pragma once
/// More viscosity in the mercury than the regularising one: p = max(p0 - K e_v - (eta + zeta) de_v/dt, -sigma_c). Attenuation grows as
/// the square of the frequency and with the path through the mercury. Off: zeta = 0 (physics.md section 3).
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

MechanismEntry liquid_viscosity();

}  // namespace calomel
