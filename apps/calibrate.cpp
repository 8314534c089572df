#include "apps/stages.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_calibrate(const CommandLine& command) {
  Stages stages(command);
  auto status = ExitStatus::done;
  for (const auto& method : command.methods) status = worse(status, stages.calibrate(method));
  return status;
}

}  // namespace calomel
