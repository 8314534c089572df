#include "apps/pipeline/stages.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_sample(const CommandLine& command) { return Stages(command).sample(); }

}  // namespace calomel
