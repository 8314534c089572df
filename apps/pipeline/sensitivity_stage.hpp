#pragma once
#include "apps/pipeline/stage_call.hpp"

namespace calomel {

/// sensitivity: of the trained surrogate, which is made first where it is missing, or of a line or an external model itself (a [surrogate] table requests a
/// surrogate of these, too); sensitivity.json, .nc and .csv.
ExitStatus sensitivity_stage(StageCall& call);

}  // namespace calomel
