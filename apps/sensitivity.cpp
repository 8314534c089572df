#include "apps/pipeline/call_stage.hpp"
#include "apps/pipeline/sensitivity_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_sensitivity(const CommandLine& command) {
  return call_stage(command, [](StageCall& call) { return sensitivity_stage(call); });
}

}  // namespace calomel
