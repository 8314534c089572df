#include "apps/pipeline/call_stage.hpp"
#include "apps/pipeline/campaign_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_campaign_verb(const CommandLine& command) {
  return call_stage(command, [](StageCall& call) { return campaign_stage(call); });
}

}  // namespace calomel
