#include "apps/pipeline/check_stage.hpp"

#include <iostream>

#include "apps/pipeline/external_stages.hpp"
#include "apps/pipeline/floor_stage.hpp"
#include "apps/pipeline/line_stages.hpp"
#include "apps/pipeline/stage_call.hpp"
#include "apps/presentation/case_lines.hpp"
#include "base/json.hpp"
#include "forward/mesh/write_mesh.hpp"
#include "forward/repeatability.hpp"

namespace calomel {

namespace {

/// On `threads` threads.
StudyCost cost_of(const StudyCase& study, const BuiltInModel& model, const ModelDescription& d, int threads) {
  const double conditions = double(model.shape().conditions.size()), mean = d.estimated_mean_seconds / threads;
  const bool finer = study.floor.finer_mesh && finer_is_small_enough(study.floor, model.mesh());
  return {.run = conditions * d.estimated_seconds / d.run_gain,
          .campaign = double(study.campaign.runs) * conditions * mean,
          .floor = conditions * floor_cost(study.floor, model.mesh().plane_strain, finer, d.estimated_seconds / d.estimated_mean_seconds) * mean};
}

}  // namespace

ExitStatus check_stage(StageCall& call) {
  auto& inputs = call.inputs;
  if (inputs.study().line) return check_line_stage(call);
  if (inputs.study().external) return check_external_stage(call);
  const auto& command = inputs.command();
  const auto& study = inputs.study();
  const auto& model = inputs.model();
  const auto description = model.describe();
  const Problem* problem = study.recordings ? &inputs.problem() : nullptr;  // what is wrong with the recordings comes before any word of success
  const auto lines = plan_lines({.study = study,
                                 .model = description,
                                 .shape = model.shape(),
                                 .mesh = model.mesh(),
                                 .problem = problem,
                                 .cost = cost_of(study, model, description, command.threads),
                                 .threads = command.threads});
  if (command.resolved) std::cout << study.echo().dump(2) << '\n';
  command.resolved ? inputs.notes().say(lines) : Notes(std::cout, false).say(lines);
  std::cout.flush();
  inputs.notes().warn(description.warnings);
  for (const auto& n : description.notes) inputs.notes().say("note: " + n);
  if (!command.write_mesh.empty()) {
    write_mesh(model.mesh(), command.write_mesh);
    inputs.notes().say(mesh_written_line(command.write_mesh));
  }
  if (command.floor) floor_stage(call);
  return ExitStatus::done;
}

}  // namespace calomel
