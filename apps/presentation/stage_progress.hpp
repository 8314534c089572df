#pragma once
/// Progress of a stage that does one thing after another.
#include <string>

#include "inverse/calibration/calibration.hpp"

namespace calomel {

/// What is done of `stage`, told on a display of its own for each thing that is done, or not at all when quiet. Throws Interrupted when the user asked to stop.
CalibrationProgress stage_progress(const std::string& stage, bool quiet);

}  // namespace calomel
