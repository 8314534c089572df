#include "apps/pipeline/floor_stage.hpp"

#include <iostream>

#include "apps/inputs/provenances.hpp"
#include "apps/interrupt.hpp"
#include "apps/pipeline/stage_call.hpp"
#include "apps/presentation/progress.hpp"
#include "apps/presentation/run_lines.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"
#include "forward/repeatability.hpp"
#include "inverse/calibration/calibration.hpp"

namespace calomel {

void floor_stage(StageCall& call) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  const auto provenance = floor_provenance(inputs);
  const auto journal = inputs.artefact("floor.journal");
  if (RunStore::identity(journal) != provenance.identity()) set_aside(journal);
  RunStore store(provenance, journal);
  const Clock clock;
  RepeatabilityFloor floor;
  {
    const auto& model = inputs.model();
    ProgressDisplay display("floor", "runs", progress_style(command.quiet), std::cerr);
    floor = measure_floor(model.forward_case(), model.ensemble(), inputs.study().floor, command.seed, command.threads,
                          {.store = &store, .progress = [&](std::size_t done, std::size_t total) { display.update(done, total); }, .stop = &stop_requested()});
  }
  Json json = floor_json(floor);
  json["wall_s"] = clock.seconds();
  json["provenance"] = provenance.json();
  write_json(inputs.artefact("floor.json"), json);
  store.remove();
  inputs.notes().say(floor_lines(floor));
}

void need_floor(StageCall& call) {
  auto& inputs = call.inputs;
  if (!call.finished.due(floor_provenance(inputs), {"floor.json"}, Asked::upstream)) return;
  inputs.notes().say(made_first_line("repeatability floor", inputs.command().out, "measuring"));
  floor_stage(call);
}

}  // namespace calomel
