#include "apps/pipeline/calibrate_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_calibrate(const CommandLine& command) {
  StageCall call(command);
  return calibrate_stage(call, command.methods);
}

}  // namespace calomel
