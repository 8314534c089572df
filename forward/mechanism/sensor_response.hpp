#pragma once
/// What a gauge's channel makes of the strain: y = g L[e_nn + k_t e_tt](t - d) + b with a gain g, a low pass L of second order (Butterworth), a
/// gauge turned by an angle in its plane, a transverse sensitivity k_t, a delay d and an offset b; for all gauges, or of one in
/// its own table. Off: g = 1, no low pass, d = angle = k_t = b = 0 (physics.md section 3).
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

MechanismEntry sensor_response();

}  // namespace calomel
