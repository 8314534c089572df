#pragma once
#include "apps/pipeline/stage_call.hpp"

namespace calomel {

/// serve: the case's model as "forward" and, where --out holds one, its surrogate with gradients as "surrogate", until the program is interrupted.
ExitStatus serve_stage(StageCall& call);

}  // namespace calomel
