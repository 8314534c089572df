#pragma once
/// Friction of a velocity profile that lags the flow's changes, after Vardy and Brown (PipeFlow), times a strength: 1 is their theory. Off: 0.
#include "forward/line/line_mechanism.hpp"

namespace calomel {

LineMechanismEntry unsteady_friction();

}  // namespace calomel
