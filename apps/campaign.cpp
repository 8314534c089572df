#include "apps/pipeline/campaign_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_campaign_verb(const CommandLine& command) {
  StageCall call(command);
  return campaign_stage(call);
}

}  // namespace calomel
