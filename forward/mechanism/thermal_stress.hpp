#pragma once
/// Heat of the pulse in the steel: sigma = C : (e - a dT 1), dT = delta_t S(y, z) exp(-x / decay), x the depth below the outer front face and S the transverse
/// shape of the load; it rises with the pulse and its energy as p0 does. Constant in an element. Off: delta_t = 0 (physics.md section 3).
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

/// a of 316L between 20 and 100 C [1/K] (EN 10088-1, 1.4401 and 1.4404: 16.0e-6).
inline constexpr double steel_expansion = 16e-6;

MechanismEntry thermal_stress();

}  // namespace calomel
