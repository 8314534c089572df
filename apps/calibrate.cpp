#include "apps/pipeline/call_stage.hpp"
#include "apps/pipeline/calibrate_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_calibrate(const CommandLine& command) {
  return call_stage(command, [&](StageCall& call) { return calibrate_stage(call, command.methods); });
}

}  // namespace calomel
