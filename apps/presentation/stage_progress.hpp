#pragma once
/// Progress of a stage that does one thing after another.
#include <string>

#include "inverse/calibration/calibration.hpp"

namespace calomel {

/// Progress of `stage`, on one display for each kind of work; none when quiet. Throws Interrupted when the user requested a stop.
CalibrationProgress stage_progress(const std::string& stage, bool quiet);

}  // namespace calomel
