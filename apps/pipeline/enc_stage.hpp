#pragma once
/// Evolutionary neural calibration of a case: enc.nc and enc.json.
#include "apps/pipeline/stage_call.hpp"
#include "inverse/enc/enc.hpp"

namespace calomel {

/// surrogate.nc and campaign.nc exist. Errors: see run_enc and FittedCorrection.
EncSummary enc_stage(StageCall& call, const Provenance& provenance, const CalibrationProgress& progress);

}  // namespace calomel
