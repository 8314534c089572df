#include "apps/pipeline/campaign_stage.hpp"

#include <iostream>

#include "apps/inputs/provenances.hpp"
#include "apps/pipeline/floor_stage.hpp"
#include "apps/pipeline/stage_call.hpp"
#include "apps/presentation/progress.hpp"
#include "apps/presentation/run_lines.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"
#include "forward/campaign/campaign.hpp"

namespace calomel {

ExitStatus campaign_stage(StageCall& call, Requested requested) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  const auto& campaign = inputs.study().campaign;
  const auto provenance = campaign_provenance(inputs);
  if (call.finished.to_be_set_aside(provenance, requested)) set_campaign_aside(command.out);
  const bool finished = std::filesystem::exists(inputs.artefact("campaign.nc"));
  if (!finished && requested == Requested::upstream) inputs.notes().say(made_first_line("finished campaign", command.out, "running"));
  CampaignSummary summary;
  {
    std::optional<ProgressDisplay> display(std::in_place, "campaign", "runs", progress_style(command.quiet || finished), std::cerr);
    FloorSource floor;
    if (campaign.floor && inputs.study().capabilities().numerics && (requested == Requested::by_user || !finished))
      floor = [&] {
        display.reset();
        need_floor(call);
        return read_floor(read_json(inputs.artefact("floor.json")));
      };
    const auto progress = [&](std::size_t done, std::size_t failed, std::size_t runs) { display->update(done, runs, failed_note(failed)); };
    summary = inputs.study().file.locating([&] {
      return run_campaign(
          inputs.simulator().shape(), campaign, command.seed, provenance, command.out, [&]() -> Runs& { return inputs.runs(); }, progress, floor);
    });
  }
  if (requested == Requested::by_user || !finished) inputs.notes().say(campaign_line(summary));
  return summary.status;
}

}  // namespace calomel
