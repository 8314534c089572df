#include "apps/pipeline/calibrate_stage.hpp"
#include "apps/pipeline/campaign_stage.hpp"
#include "apps/pipeline/report_stage.hpp"
#include "apps/pipeline/sample_stage.hpp"
#include "apps/pipeline/sensitivity_stage.hpp"
#include "apps/pipeline/simulate_stage.hpp"
#include "apps/pipeline/stage_call.hpp"
#include "apps/pipeline/train_stage.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_study(const CommandLine& command) {
  StageCall call(command);
  const auto& options = call.inputs.study().study;
  auto status = ExitStatus::done;
  for (const auto& stage : options.stages) {
    if (stage == "simulate") status = worse(status, simulate_stage(call));
    if (stage == "campaign") status = worse(status, campaign_stage(call));
    if (stage == "train") status = worse(status, train_stage(call));
    if (stage == "calibrate") status = worse(status, calibrate_stage(call, options.methods));
    if (stage == "sample") status = worse(status, sample_stage(call));
    if (stage == "sensitivity") status = worse(status, sensitivity_stage(call));
    if (stage == "report") status = worse(status, report_stage(call));
  }
  return status;
}

}  // namespace calomel
