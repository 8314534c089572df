#include "apps/pipeline/call_stage.hpp"
#include "apps/pipeline/check_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_check(const CommandLine& command) {
  return call_stage(command, [](StageCall& call) { return check_stage(call); });
}

}  // namespace calomel
