#include "apps/pipeline/simulate_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_simulate(const CommandLine& command) {
  StageCall call(command);
  return simulate_stage(call);
}

}  // namespace calomel
