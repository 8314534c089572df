#include "apps/pipeline/stages.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_campaign_verb(const CommandLine& command) { return Stages(command).campaign(); }

}  // namespace calomel
