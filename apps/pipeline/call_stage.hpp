#pragma once
/// How a verb comes to its stage.
#include <functional>

#include "apps/command_line.hpp"

namespace calomel {

struct StageCall;

/// Calls `stage` with what the stages of one call share. Errors: as StageCall, and those of the stage.
ExitStatus call_stage(const CommandLine& command, const std::function<ExitStatus(StageCall&)>& stage);

}  // namespace calomel
