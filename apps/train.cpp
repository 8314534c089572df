#include "apps/pipeline/stages.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_train(const CommandLine& command) { return Stages(command).train(); }

}  // namespace calomel
