#include "apps/pipeline/call_stage.hpp"
#include "apps/pipeline/train_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_train(const CommandLine& command) {
  return call_stage(command, [](StageCall& call) { return train_stage(call); });
}

}  // namespace calomel
