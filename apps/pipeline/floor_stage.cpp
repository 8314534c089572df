#include "apps/pipeline/floor_stage.hpp"

#include <iostream>

#include "apps/inputs/provenances.hpp"
#include "apps/pipeline/stage_call.hpp"
#include "apps/presentation/progress.hpp"
#include "apps/presentation/run_lines.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"
#include "forward/campaign/repeatability.hpp"
#include "inverse/calibration/calibration.hpp"

namespace calomel {

void floor_stage(StageCall& call) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  const auto provenance = floor_provenance(inputs);
  const Clock clock;
  RepeatabilityFloor floor;
  {
    ProgressDisplay display("floor", "runs", progress_style(command.quiet), std::cerr);
    floor = measure_floor(inputs.runs(), inputs.study().floor, command.seed, [&](std::size_t done, std::size_t total) { display.update(done, total); });
  }
  Json json = floor_json(floor);
  json["wall_s"] = clock.seconds();
  json["provenance"] = provenance.json();
  write_json(inputs.artefact("floor.json"), json);
  inputs.notes().say(floor_lines(floor));
}

void need_floor(StageCall& call) {
  auto& inputs = call.inputs;
  if (!call.finished.due(floor_provenance(inputs), {"floor.json"}, Requested::upstream)) return;
  inputs.notes().say(made_first_line("repeatability floor", inputs.command().out, "measuring"));
  floor_stage(call);
}

}  // namespace calomel
