#include "apps/pipeline/sample_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_sample(const CommandLine& command) {
  StageCall call(command);
  return sample_stage(call);
}

}  // namespace calomel
