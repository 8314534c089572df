#pragma once
#include "apps/pipeline/stage_call.hpp"

namespace calomel {

/// check of a line: what will be run, and its warnings.
ExitStatus check_line_stage(StageCall& call);
/// simulate of a line: simulate.nc and simulate.json, at the numbers of its tables.
ExitStatus simulate_line_stage(StageCall& call);

}  // namespace calomel
