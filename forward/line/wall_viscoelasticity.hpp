#pragma once
/// A wall that goes on yielding: one Kelvin-Voigt element in series with the elastic line (PipeFlow). Off: no retarded compliance.
#include "forward/line/line_mechanism.hpp"

namespace calomel {

LineMechanismEntry wall_viscoelasticity();

}  // namespace calomel
