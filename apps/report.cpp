#include "apps/pipeline/call_stage.hpp"
#include "apps/pipeline/report_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_report(const CommandLine& command) {
  return call_stage(command, [](StageCall& call) { return report_stage(call); });
}

}  // namespace calomel
