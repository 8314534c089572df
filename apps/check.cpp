#include "apps/pipeline/check_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_check(const CommandLine& command) {
  StageCall call(command);
  return check_stage(call);
}

}  // namespace calomel
