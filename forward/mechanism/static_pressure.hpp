#pragma once
/// A static pressure p_s of the mercury, by its cover gas or the loop: it is put under tension from p_s on, so that p = max(p0 - K e_v - eta de_v/dt, -(sigma_c
/// + p_s)), p counted from the state of rest. The motion contains no more than the sum sigma_c + p_s: records at one p_s cannot distinguish the two. Off: 0
/// (physics.md section 3).
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

MechanismEntry static_pressure();

}  // namespace calomel
