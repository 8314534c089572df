#pragma once
/// The pressure of a liquid does not fall below its vapour pressure: cavities open at the nodes (PipeFlow). The law of mercury's tensile cutoff. Off: no such
/// pressure.
#include "forward/line/line_mechanism.hpp"

namespace calomel {

LineMechanismEntry vapour_cutoff();

}  // namespace calomel
