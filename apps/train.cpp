#include "apps/pipeline/train_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_train(const CommandLine& command) {
  StageCall call(command);
  return train_stage(call);
}

}  // namespace calomel
