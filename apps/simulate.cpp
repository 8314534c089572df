#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <iostream>

#include "apps/interrupt.hpp"
#include "apps/progress.hpp"
#include "apps/pipeline/stages.hpp"
#include "apps/verbs.hpp"
#include "base/artefact.hpp"
#include "base/netcdf_file.hpp"
#include "base/provenance.hpp"
#include "forward/mesh/exodus_fields.hpp"
#include "forward/solver/kernel.hpp"

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

/// Fields of a run, of the first condition, that may be cut off and gone on with.
class RunFields {
 public:
  RunFields(std::filesystem::path path, const Mesh& mesh, double interval, SolveOptions& options) : path_(std::move(path)), mesh_(mesh) {
    options.field_interval = interval;
    options.on_field = [this, balanced = options.energy_balance](const FieldSnapshot& s) {
      if (!writer_) writer_.emplace(path_, mesh_);
      writer_->write_step({s.time, s.displacement, s.velocity, s.pressure, s.effective_stress, balanced ? s.time_at_cutoff : std::span<const double>{}});
    };
    options.checkpoint.before_saving = [this](std::int64_t) {
      if (writer_) writer_->flush();
    };
    options.checkpoint.on_resume = [this](std::int64_t, std::int64_t fields, bool finished) {
      if (finished && fields_committed()) return;  // by the call that finished this condition
      writer_.emplace(path_, mesh_, int(fields));
    };
  }
  void commit() {
    if (writer_) writer_->commit(), writer_.reset();
  }
  /// The run was stopped: the fields so far stay for the one that goes on.
  void leave() {
    if (writer_) writer_->leave();
  }

 private:
  [[nodiscard]] bool fields_committed() const { return std::filesystem::exists(path_) && !std::filesystem::exists(path_.string() + ".part"); }
  std::filesystem::path path_;
  const Mesh& mesh_;
  std::optional<ExodusFieldWriter> writer_;
};

/// What simulate.json tells of a single run.
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
  if (balanced) json.update({{"greatest_wall_stress_Pa", s.greatest_stress}, {"greatest_wall_stress_at_m", s.greatest_stress_at}});
  return json;
}

}  // namespace

std::vector<double> Stages::simulate_mean(Json& json) {
  if (command_.fields)
    throw InputError({.problem = "fields are of one run, --mean is of several", .key = "--fields", .suggestion = "leave one of the two out"});
  const auto& forward = study_.forward;
  const auto description = model().describe();
  std::vector<double> theta;
  for (const auto& p : forward.parameters) theta.push_back(forward.number(p.key));
  const auto began = std::chrono::steady_clock::now();
  auto prediction = model().evaluate(theta);
  if (!prediction.ok) throw NumericsError(prediction.message);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  const double runs = double(prediction.energies.size() * model().shape().conditions.size());
  json.update({{"steps", description.steps},
               {"time_step_s", description.time_step},
               {"subcycles", description.subcycles},
               {"wall_s", wall},
               {"element_steps_per_s", runs * double(description.elements) * double(description.steps) / wall},
               {"energy_balance_error", nullptr},
               {"pulse_energies", prediction.energies}});
  return std::move(prediction.mean);
}

std::vector<double> Stages::simulate_once(const Provenance& provenance, Json& json) {
  const auto& m = model();
  const auto& forward = study_.forward;
  SolveOptions options = solve_options(forward.solver);
  options.energy_balance = forward.solver.energy_balance;
  options.threads = command_.threads;
  options.stop = &stop_requested();
  ProgressDisplay display("simulate", "%", progress_style(command_.quiet), std::cerr);
  options.on_progress = [&](double share) { display.update(std::size_t(100 * share), 100); };

  const double interval = study_.fields.interval.value_or(forward.time.end / 50);
  if (forward.solver.checkpoint > 0) {
    options.checkpoint.path = command_.out / "simulate.checkpoint";
    options.checkpoint.every_seconds = forward.solver.checkpoint;
    options.checkpoint.identity = fmt::format("{} {} {} fields {}", version, kernels<double>().name, provenance.identity(), command_.fields ? interval : 0);
    if (command_.fresh)
      for (const auto& path : m.checkpoints(options.checkpoint.path)) set_aside(path);
  }
  std::optional<RunFields> fields;
  if (command_.fields) fields.emplace(command_.out / "fields.exo", m.mesh(), interval, options);
  const auto& conditions = m.shape().conditions;
  std::size_t condition = 0;  // under way
  options.checkpoint.on_resume = [&, reopen = options.checkpoint.on_resume](std::int64_t step, std::int64_t written, bool finished) {
    if (reopen && condition == 0) reopen(step, written, finished);
    const std::string which = conditions.size() > 1 ? "condition " + conditions[condition] + ' ' : "";
    say("simulate: " + which + (finished ? "is finished and kept" : fmt::format("goes on from step {}", step)));
  };
  try {
    auto run = m.simulate(options, [&](std::size_t finished) {
      if (fields && finished == 0) fields->commit();
      condition = finished + 1;
    });
    json.update(of_run(run.summary, options.energy_balance));
    return std::move(run.strain);
  } catch (const Interrupted&) {
    if (fields && condition == 0 && std::filesystem::exists(m.checkpoints(options.checkpoint.path).front())) fields->leave();
    throw;
  }
}

void Stages::tell_nominals_left_out() const {
  for (const auto& p : study_.forward.parameters) {
    const double table = study_.forward.number(p.key);
    if (!p.nominal || *p.nominal == table) continue;
    const InputError told = study_.file.located(InputError({.problem = "simulate takes the numbers of the tables, so this has no effect on it",
                                                            .key = "parameter." + p.name + ".nominal",
                                                            .value = number_text(*p.nominal),
                                                            .suggestion = fmt::format("set {} itself, which is {}: --set {}={}", p.key, number_text(table), p.key, number_text(*p.nominal))}));
    if (command_.verb == "simulate" && told.parts().file.starts_with("--set ")) throw told;
    say(std::string("warning: ") + told.what());
  }
}

ExitStatus Stages::simulate() {
  tell_nominals_left_out();
  const auto& m = model();
  const auto description = m.describe();
  Provenance provenance{.stage = "simulate", .options = study_.model_options(), .seed = command_.seed, .inputs = study_.model_inputs()};
  provenance.options["solver"]["energy_balance"] = study_.forward.solver.energy_balance;  // its summary and its checkpoint hold the energies
  for (const auto& w : description.warnings) say("warning: " + w);
  for (const auto& line : physics()) say(line);

  Json json{{"elements", description.elements}, {"nodes", description.nodes}};
  const auto strain = command_.mean ? simulate_mean(json) : simulate_once(provenance, json);
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
