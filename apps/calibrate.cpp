#include "apps/pipeline/stages.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_calibrate(const CommandLine& command) { return Stages(command).calibrate(command.methods); }

}  // namespace calomel
