#include "apps/pipeline/stages.hpp"
#include "apps/verbs.hpp"

namespace calomel {

ExitStatus run_study(const CommandLine& command) {
  Stages stages(command);
  auto status = ExitStatus::done;
  for (const auto& stage : stages.study().study.stages) {
    if (stage == "simulate") status = worse(status, stages.simulate());
    if (stage == "campaign") status = worse(status, stages.campaign());
    if (stage == "train") status = worse(status, stages.train());
    if (stage == "calibrate") status = worse(status, stages.calibrate(stages.study().study.methods));
    if (stage == "sample") status = worse(status, stages.sample());
    if (stage == "report") status = worse(status, stages.report());
  }
  return status;
}

}  // namespace calomel
