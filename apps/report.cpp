#include "apps/pipeline/report_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_report(const CommandLine& command) {
  StageCall call(command);
  return report_stage(call);
}

}  // namespace calomel
