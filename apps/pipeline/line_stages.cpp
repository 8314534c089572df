#include "apps/pipeline/line_stages.hpp"

#include <iostream>

#include "apps/inputs/provenances.hpp"
#include "apps/pipeline/histories_file.hpp"
#include "apps/presentation/line_lines.hpp"
#include "apps/presentation/progress.hpp"
#include "apps/presentation/run_lines.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/provenance.hpp"

namespace calomel {

ExitStatus check_line_stage(StageCall& call) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  refuse(!command.write_mesh.empty(), "--write-mesh", "a line has no mesh");
  refuse(command.floor, "--floor", "the repeatability floor is that of a model on a mesh");
  const auto description = inputs.line().describe();
  const Problem* problem = inputs.study().recordings ? &inputs.problem() : nullptr;
  const auto lines = line_plan_lines(inputs.line(), description, problem);
  if (command.resolved) std::cout << inputs.study().echo().dump(2) << '\n';
  command.resolved ? inputs.notes().say(lines) : Notes(std::cout, false).say(lines);
  std::cout.flush();
  for (const auto& n : description.notes) inputs.notes().say("note: " + n);
  return ExitStatus::done;
}

ExitStatus simulate_line_stage(StageCall& call) {
  auto& inputs = call.inputs;
  refuse(inputs.command().fields, "--fields", "fields are of a model on a mesh");
  refuse(inputs.command().mean, "--mean", "a line has no pulses to take a mean over");
  const auto& model = inputs.line();
  const auto description = model.describe();
  std::vector<double> theta;  // the numbers of the tables, as of the model on a mesh
  for (const auto& p : model.shape().parameters) theta.push_back(model.line_case().number(p.key));
  const Clock clock;
  const auto prediction = model.evaluate(theta);
  const double wall = clock.seconds();
  if (!prediction.ok) throw NumericsError(prediction.message);
  const auto provenance = simulate_provenance(inputs);
  const double cell_steps = double(description.cells) * double(description.steps);
  write_histories(inputs.artefact("simulate.nc"), model.shape(), prediction.mean, provenance);
  write_json(inputs.artefact("simulate.json"), {{"elements", description.cells},
                                                {"nodes", description.nodes},
                                                {"element_steps", cell_steps},
                                                {"steps", description.steps},
                                                {"time_step_s", description.time_step},
                                                {"wall_s", wall},
                                                {"element_steps_per_s", cell_steps / wall},
                                                {"energy_balance_error", nullptr},
                                                {"mechanisms", description.active},
                                                {"warnings", Json::array()},
                                                {"provenance", provenance.json()}});
  inputs.notes().say(
      simulate_line({.elements = description.cells, .steps = std::int64_t(description.steps), .wall = wall, .element_steps = cell_steps / wall}));
  return ExitStatus::done;
}

}  // namespace calomel
