#include "apps/pipeline/call_stage.hpp"
#include "apps/pipeline/sample_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_sample(const CommandLine& command) {
  return call_stage(command, [](StageCall& call) { return sample_stage(call); });
}

}  // namespace calomel
