#pragma once
/// The pulse as it was rather than as it was meant: offset, widths, strength and length of the source. Off: no offset, ratios 1,
/// the length in [load] (physics.md section 3).
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

MechanismEntry beam_profile();

}  // namespace calomel
