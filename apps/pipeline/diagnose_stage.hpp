#pragma once
/// The diagnosis of omitted physics.
#include "apps/pipeline/stage_call.hpp"

namespace calomel {

/// Writes diagnosis.json. The case is taken with the handbook's priors (map.product = "physical"). not_to_be_trusted where the base fit did not settle.
ExitStatus diagnose_stage(StageCall& call);

}  // namespace calomel
