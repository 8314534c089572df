#include "apps/pipeline/simulate_stage.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iostream>

#include "apps/inputs/provenances.hpp"
#include "apps/interrupt.hpp"
#include "apps/pipeline/histories_file.hpp"
#include "apps/pipeline/external_stages.hpp"
#include "apps/pipeline/line_stages.hpp"
#include "apps/pipeline/run_fields.hpp"
#include "apps/pipeline/stage_call.hpp"
#include "apps/presentation/case_lines.hpp"
#include "apps/presentation/progress.hpp"
#include "apps/presentation/run_lines.hpp"
#include "base/artefact.hpp"
#include "base/provenance.hpp"
#include "forward/solver/kernel.hpp"
#include "inverse/calibration/calibration.hpp"

namespace calomel {

namespace {

/// What came of it, and what simulate.json tells of it.
struct Simulated {
  std::vector<double> strain;  ///< (condition, sensor, time)
  Json json;
};

Json finite(double x) { return std::isfinite(x) ? Json(x) : Json(); }

Json of_run(const SolveSummary& s, bool balanced) {
  Json json{{"steps", s.steps},
            {"time_step_s", s.time_step},
            {"subcycles", s.subcycles},
            {"resumed_from_step", s.resumed_from},
            {"wall_s", s.wall_seconds},
            {"processor_s", s.processor_seconds},
            {"element_steps_per_s", s.element_steps_per_second},
            {"energy_balance_error", finite(s.energy_balance_error)},
            {"hourglass_share", finite(s.hourglass_share)},
            {"energy_in_J", s.energy_in},
            {"dissipated_J", s.dissipated},
            {"radiated_J", s.radiated},
            {"kernel", s.kernel}};
  if (balanced)
    json.update({{"time_at_cutoff_s", s.time_at_cutoff}, {"greatest_wall_stress_Pa", s.greatest_stress}, {"greatest_wall_stress_at_m", s.greatest_stress_at}});
  return json;
}

/// The ensemble mean.
Simulated simulate_mean(StudyInputs& inputs) {
  if (inputs.command().fields)
    throw InputError({.problem = "fields are of one run, --mean is of several", .key = "--fields", .suggestion = "leave one of the two out"});
  const auto& forward = inputs.study().forward;
  const auto& model = inputs.model();
  const auto description = model.describe();
  std::vector<double> theta;
  for (const auto& p : forward.parameters) theta.push_back(forward.number(p.key));
  const Clock clock;
  auto prediction = model.evaluate(theta);
  if (!prediction.ok) throw NumericsError(prediction.message);
  const double wall = clock.seconds();
  const double runs = double(prediction.energies.size() * model.shape().conditions.size());
  return {.strain = std::move(prediction.mean),
          .json = {{"steps", description.steps},
                   {"time_step_s", description.time_step},
                   {"subcycles", description.subcycles},
                   {"wall_s", wall},
                   {"element_steps_per_s", runs * double(description.elements) * double(description.steps) / wall},
                   {"energy_balance_error", nullptr},
                   {"pulse_energies", prediction.energies}}};
}

/// One run, gone on with where an earlier one was cut off.
Simulated simulate_once(StudyInputs& inputs, const Provenance& provenance) {
  const auto& command = inputs.command();
  const auto& model = inputs.model();
  const auto& forward = inputs.study().forward;
  SolveOptions options = solve_options(forward.solver);
  options.energy_balance = forward.solver.energy_balance;
  options.threads = command.threads;
  options.stop = &stop_requested();
  ProgressDisplay display("simulate", "%", progress_style(command.quiet), std::cerr);
  options.on_progress = [&](double share) { display.update(std::size_t(100 * share), 100); };

  const double interval = inputs.study().fields.interval.value_or(forward.time.end / 50);
  if (forward.solver.checkpoint > 0) {
    options.checkpoint.path = inputs.artefact("simulate.checkpoint");
    options.checkpoint.every_seconds = forward.solver.checkpoint;
    options.checkpoint.identity = fmt::format("{} {} {} fields {}", version, kernels<double>().name, provenance.identity(), command.fields ? interval : 0);
    if (command.fresh)
      for (const auto& path : model.checkpoints(options.checkpoint.path)) set_aside(path);
  }
  std::optional<RunFields> fields;
  if (command.fields) fields.emplace(inputs.artefact("fields.exo"), model.mesh(), interval, options);
  const auto& conditions = model.shape().conditions;
  std::size_t condition = 0;  // under way
  options.checkpoint.on_resume = [&, reopen = options.checkpoint.on_resume](std::int64_t step, std::int64_t written, bool finished) {
    if (reopen && condition == 0) reopen(step, written, finished);
    inputs.notes().say(resumed_line(conditions.size() > 1 ? conditions[condition] : "", step, finished));
  };
  try {
    auto run = model.simulate(options, [&](std::size_t finished) {
      if (fields && finished == 0) fields->commit();
      condition = finished + 1;
    });
    return {.strain = std::move(run.strain), .json = of_run(run.summary, options.energy_balance)};
  } catch (const Interrupted&) {
    if (fields && condition == 0 && std::filesystem::exists(model.checkpoints(options.checkpoint.path).front())) fields->leave();
    throw;
  }
}

void tell_nominals_left_out(const StudyInputs& inputs) {
  for (const auto& told : nominals_left_out(inputs.study())) {
    if (inputs.command().verb == "simulate" && told.parts().file.starts_with("--set ")) throw told;
    inputs.notes().warn(told.what());
  }
}

}  // namespace

ExitStatus simulate_stage(StageCall& call) {
  auto& inputs = call.inputs;
  if (inputs.study().line) return simulate_line_stage(call);
  if (inputs.study().external) return simulate_external_stage(call);
  tell_nominals_left_out(inputs);
  const auto& model = inputs.model();
  const auto description = model.describe();
  const auto provenance = simulate_provenance(inputs);
  inputs.notes().warn(description.warnings);
  inputs.notes().say(physics_lines(inputs.study().forward.load, description, model.mesh().plane_strain));

  const auto simulated = inputs.command().mean ? simulate_mean(inputs) : simulate_once(inputs, provenance);
  Json json{{"elements", description.elements}, {"nodes", description.nodes}, {"element_steps", description.element_steps}};
  json.update(simulated.json);
  json["regularising_viscosity"] = description.viscosity;
  json["deposited_energy_J"] = description.deposited_energy;
  json["warnings"] = description.warnings;
  json["provenance"] = provenance.json();
  write_histories(inputs.artefact("simulate.nc"), model.shape(), simulated.strain, provenance);
  write_json(inputs.artefact("simulate.json"), json);
  inputs.notes().say(simulate_line({.elements = description.elements,
                                    .steps = json["steps"].get<std::int64_t>(),
                                    .wall = json["wall_s"].get<double>(),
                                    .element_steps = json["element_steps_per_s"].get<double>()}));
  return ExitStatus::done;
}

}  // namespace calomel
