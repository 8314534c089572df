#pragma once
/// Sparse polynomial calibration of a case: spe.nc and spe.json.
#include "apps/pipeline/stage_call.hpp"
#include "inverse/spe/spe.hpp"

namespace calomel {

/// campaign.nc exists; further runs are taken from and kept in runs.journal. Errors: see run_spe and FittedCorrection.
SpeSummary spe_stage(StageCall& call, const Provenance& provenance, const CalibrationProgress& progress);

}  // namespace calomel
