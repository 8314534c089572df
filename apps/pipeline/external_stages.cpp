#include "apps/pipeline/external_stages.hpp"

#include <iostream>

#include "apps/inputs/provenances.hpp"
#include "apps/pipeline/histories_file.hpp"
#include "apps/presentation/external_lines.hpp"
#include "apps/presentation/progress.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/provenance.hpp"

namespace calomel {

ExitStatus check_external_stage(StageCall& call) {
  auto& inputs = call.inputs;
  const auto& command = inputs.command();
  refuse(!command.write_mesh.empty(), "--write-mesh", "a model outside of the program has no mesh");
  refuse(command.floor, "--floor", "the repeatability floor is that of a model on a mesh");
  const auto& model = inputs.external();
  const Problem* problem = inputs.study().recordings ? &inputs.problem() : nullptr;
  const auto lines = external_plan_lines(model, problem);
  if (command.resolved) std::cout << inputs.study().echo().dump(2) << '\n';
  command.resolved ? inputs.notes().say(lines) : Notes(std::cout, false).say(lines);
  std::cout.flush();
  return ExitStatus::done;
}

ExitStatus simulate_external_stage(StageCall& call) {
  auto& inputs = call.inputs;
  refuse(inputs.command().fields, "--fields", "fields are of a model on a mesh");
  refuse(inputs.command().mean, "--mean", "a model outside of the program gives its mean itself; set its pulses in [model.config]");
  const auto& model = inputs.external();
  const auto theta = nominal(model.shape());
  const Clock clock;
  const auto prediction = model.evaluate(theta);
  const double wall = clock.seconds();
  if (!prediction.ok) throw NumericsError(prediction.message);
  const auto provenance = simulate_provenance(inputs);
  write_histories(inputs.artefact("simulate.nc"), model.shape(), prediction.mean, provenance);
  const Json none = nullptr;  // nobody outside knows
  write_json(inputs.artefact("simulate.json"), {{"elements", none},
                                                {"nodes", none},
                                                {"steps", none},
                                                {"time_step_s", none},
                                                {"wall_s", wall},
                                                {"element_steps_per_s", none},
                                                {"energy_balance_error", none},
                                                {"theta", named(model.shape().parameters, theta)},
                                                {"warnings", Json::array()},
                                                {"provenance", provenance.json()}});
  inputs.notes().say(external_simulate_line(model, wall));
  return ExitStatus::done;
}

}  // namespace calomel
