#pragma once
#include "apps/pipeline/stage_call.hpp"

namespace calomel {

/// check of a model outside: asks its server, and tells what will be run.
ExitStatus check_external_stage(StageCall& call);
/// simulate of a model outside: simulate.nc and simulate.json, at the nominal values.
ExitStatus simulate_external_stage(StageCall& call);

}  // namespace calomel
