#include "apps/pipeline/call_stage.hpp"
#include "apps/pipeline/diagnose_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_diagnose(const CommandLine& command) {
  // Handbook priors and a discrepancy: what is asked is whether the model is right, not which numbers imitate the records.
  CommandLine physical = command;
  physical.overrides.emplace_back("map.product=\"physical\"");
  return call_stage(physical, [](StageCall& call) { return diagnose_stage(call); });
}

}  // namespace calomel
