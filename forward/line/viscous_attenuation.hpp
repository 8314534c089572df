#pragma once
/// A bar of Kelvin and Voigt's viscosity: sigma = E (e + theta de/dt), so that waves lose omega^2 theta / 2 c0 per metre while omega theta is small. Off: theta
/// = 0.
#include "forward/line/line_mechanism.hpp"

namespace calomel {

LineMechanismEntry viscous_attenuation();

}  // namespace calomel
