#pragma once
#include "apps/pipeline/stage_call.hpp"

namespace calomel {

/// sample of an external model: its posterior, or its log density, by the model itself; posterior.nc and posterior.json.
ExitStatus sample_model_stage(StageCall& call);

}  // namespace calomel
