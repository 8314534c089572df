#include "apps/pipeline/call_stage.hpp"
#include "apps/pipeline/simulate_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_simulate(const CommandLine& command) {
  return call_stage(command, [](StageCall& call) { return simulate_stage(call); });
}

}  // namespace calomel
