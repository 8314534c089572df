#include "apps/pipeline/simulate_stage.hpp"

#include <iostream>

#include "apps/inputs/provenances.hpp"
#include "apps/interrupt.hpp"
#include "apps/pipeline/histories_file.hpp"
#include "apps/pipeline/stage_call.hpp"
#include "apps/presentation/case_lines.hpp"
#include "apps/presentation/progress.hpp"
#include "apps/presentation/run_lines.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/provenance.hpp"

namespace calomel {

namespace {

void warn_of_nominals_left_out(const StudyInputs& inputs) {
  for (const auto& left_out : nominals_left_out(inputs.study())) {
    if (inputs.command().verb == "simulate" && left_out.parts().file.starts_with("--set ")) throw left_out;
    inputs.notes().warn(left_out.what());
  }
}

}  // namespace

ExitStatus simulate_stage(StageCall& call) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  const auto& study = inputs.study();
  const Simulator& simulator = inputs.simulator();
  return study.file.locating([&] {
    warn_of_nominals_left_out(inputs);
    const Description description = simulator.describe(command.threads);
    const auto provenance = simulate_provenance(inputs);
    inputs.notes().warn(description.warnings);
    inputs.notes().say(fact_lines(description.physics));
    std::optional<ProgressDisplay> display;
    SimulateCall simulate{.mean = command.mean, .threads = command.threads, .stop = &stop_requested()};
    simulate.checkpoint = inputs.artefact("simulate.checkpoint");
    simulate.identity = provenance.identity();
    simulate.fresh = command.fresh;
    if (command.fields) simulate.fields = inputs.artefact("fields.exo");
    simulate.field_interval = study.fields.interval;
    simulate.progress = [&](double share) {
      if (!display) display.emplace("simulate", "%", progress_style(command.quiet), std::cerr);
      display->update(std::size_t(100 * share), 100);
    };
    simulate.resumed = [&](const std::string& condition, std::int64_t step, bool finished) { inputs.notes().say(resumed_line(condition, step, finished)); };
    const Simulated simulated = simulator.simulate(simulate);
    display.reset();
    Json json = description.summary;
    json.update(simulated.summary);
    json["warnings"] = description.warnings;
    json["provenance"] = provenance.json();
    write_histories(inputs.artefact("simulate.nc"), simulator.shape(), simulated.values, provenance);
    write_json(inputs.artefact("simulate.json"), json);
    inputs.notes().say(simulate_line(simulated, simulator.shape().values()));
    return ExitStatus::done;
  });
}

}  // namespace calomel
