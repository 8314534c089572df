#include "apps/pipeline/call_stage.hpp"

#include "apps/pipeline/stage_call.hpp"

namespace calomel {

ExitStatus call_stage(const CommandLine& command, const std::function<ExitStatus(StageCall&)>& stage) {
  StageCall call(command);
  return stage(call);
}

}  // namespace calomel
