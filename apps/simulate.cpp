#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <iostream>

#include "apps/field_file.hpp"
#include "apps/interrupt.hpp"
#include "apps/progress.hpp"
#include "apps/stages.hpp"
#include "apps/verbs.hpp"
#include "base/netcdf_file.hpp"

namespace calomel {

namespace {

Json finite(double x) { return std::isfinite(x) ? Json(x) : Json(); }

void write_histories(const std::filesystem::path& path, const ModelShape& shape, const std::vector<double>& strain, const Provenance& provenance) {
  NetcdfWriter file(path);
  file.attribute("title", "calomel simulation");
  file.attribute("unit", shape.unit);
  file.attribute("provenance", provenance.json().dump());
  std::vector<std::string> dims{"sensor", "time"};
  if (shape.conditions.size() > 1) {
    file.dimension("condition", shape.conditions.size());
    file.variable("condition", {"condition"}, shape.conditions);
    dims.insert(dims.begin(), "condition");
  }
  file.dimension("sensor", shape.sensors.size());
  file.dimension("time", shape.times.size());
  file.variable("sensor", {"sensor"}, shape.sensors);
  file.variable("time", {"time"}, shape.times, {{"units", "s"}});
  file.variable("strain", dims, strain, {{"units", shape.unit == "strain" ? "1" : shape.unit}});
  file.commit();
}

}  // namespace

ExitStatus Stages::simulate() {
  const auto& m = model();
  const auto description = m.describe();
  const auto& forward = study_.forward;
  const Provenance provenance{.stage = "simulate", .options = study_.model_options(), .seed = command_.seed, .inputs = study_.model_inputs()};
  for (const auto& w : description.warnings) say("warning: " + w);
  say_physics();

  std::vector<double> strain;
  Json json{{"elements", description.elements}, {"nodes", description.nodes}};
  if (command_.mean) {
    if (command_.fields)
      throw InputError({.problem = "fields are of one run, --mean is of several", .key = "--fields", .suggestion = "leave one of the two out"});
    std::vector<double> theta;
    for (const auto& p : forward.parameters) theta.push_back(forward.number(p.key));
    const auto began = std::chrono::steady_clock::now();
    const BuiltInModel mean_model(forward, m.ensemble(), command_.threads);
    auto prediction = mean_model.evaluate(theta);
    if (!prediction.ok) throw NumericsError(prediction.message);
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    const double runs = double(prediction.energies.size() * m.shape().conditions.size());
    strain = std::move(prediction.mean);
    json.update({{"steps", description.steps},
                 {"time_step_s", description.time_step},
                 {"wall_s", wall},
                 {"element_steps_per_s", runs * double(description.elements) * double(description.steps) / wall},
                 {"energy_balance_error", nullptr},
                 {"pulse_energies", prediction.energies}});
  } else {
    SolveOptions options = solve_options(forward.solver);
    options.booking = forward.solver.booking;
    options.threads = command_.threads;
    options.stop = &stop_requested();
    ProgressDisplay display("simulate", "%", progress_style(command_.quiet), std::cerr);
    options.on_progress = [&](double share) { display.update(std::size_t(100 * share), 100); };
    std::optional<FieldFile> fields;
    if (command_.fields) {
      fields.emplace(command_.out / "fields.exo", m.mesh());
      options.field_interval = study_.fields.interval.value_or(forward.time.end / 50);
      options.on_field = [&](const FieldSnapshot& snapshot) { fields->write(snapshot); };
    }
    auto run = m.simulate(options);
    if (fields) fields->commit();
    strain = std::move(run.strain);
    json.update({{"steps", run.summary.steps},
                 {"time_step_s", run.summary.time_step},
                 {"wall_s", run.summary.wall_seconds},
                 {"element_steps_per_s", run.summary.element_steps_per_second},
                 {"energy_balance_error", finite(run.summary.energy_balance_error)},
                 {"hourglass_share", finite(run.summary.hourglass_share)},
                 {"energy_in_J", run.summary.energy_in},
                 {"dissipated_J", run.summary.dissipated},
                 {"radiated_J", run.summary.radiated},
                 {"kernel", run.summary.kernel}});
  }
  json["regularising_viscosity"] = description.viscosity;
  json["deposited_energy_J"] = description.deposited_energy;
  json["warnings"] = description.warnings;
  json["provenance"] = provenance.json();
  write_histories(command_.out / "simulate.nc", m.shape(), strain, provenance);
  write_json(command_.out / "simulate.json", json);
  say(fmt::format("simulate: {} elements, {} steps, {:.3g} s, {:.3g} million element-steps a second", description.elements, json["steps"].get<std::int64_t>(),
                  json["wall_s"].get<double>(), json["element_steps_per_s"].get<double>() / 1e6));
  return ExitStatus::done;
}

ExitStatus run_simulate(const CommandLine& command) { return Stages(command).simulate(); }

}  // namespace calomel
