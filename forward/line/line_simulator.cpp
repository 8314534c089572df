#include "forward/line/line_simulator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "base/artefact.hpp"
#include "forward/mechanism/added_number.hpp"
#include "forward/simulation/model_options.hpp"

namespace calomel {

LineSimulator::LineSimulator(LineCase line_case, std::map<std::string, std::filesystem::path> files)
    : model_(std::move(line_case)), files_(std::move(files)), capabilities_{.cheap_runs = true} {}

Prediction LineSimulator::evaluate(const RunRequest& request) const {
  std::map<std::string, double> further = request.numbers;
  std::vector<double> theta;
  for (const auto& p : shape().parameters) {
    const auto own = further.find(p.key);
    theta.push_back(own == further.end() ? *p.nominal : own->second);
    if (own != further.end()) further.erase(own);
  }
  return model_.evaluate(theta, further);
}

std::vector<ParameterGroup> LineSimulator::offered() const {
  std::vector<ParameterGroup> groups;
  for (const auto& m : model_.offered()) {
    ParameterGroup g{.name = m.name, .by_sensor = m.per_station && shape().sensors.size() > 1, .plain = m.plain, .check = m.check};
    for (const auto& k : m.keys)
      if (k.decides) g.added.push_back(added_number(m.name, k, k.off));
    groups.push_back(std::move(g));
  }
  return groups;
}

Description LineSimulator::describe(int) const {
  const LineCase& c = model_.line_case();
  const LineDescription d = model_.describe();
  Description out;
  const auto add = [&](const char* label, std::string text) { out.facts.push_back({label, std::move(text)}); };
  add("case", fmt::format("{}, waves along a {}", c.name, c.kind));
  const std::string grid = c.kind == "bar" ? fmt::format("{} frequencies, record of {} samples of {:.4g} s", d.cells, c.record.value.size(), d.time_step)
                                           : fmt::format("{} cells, {} steps of {:.4g} s", d.cells, d.steps, d.time_step);
  add("model", fmt::format("{}, {} stations at {} times, readings in {}", grid, shape().sensors.size(), shape().times.size(), c.unit));
  if (c.kind == "pipe")
    add("pipe",
        fmt::format("Joukowsky's pressure rho a V {:.5g} kPa, period 4 L / a {:.5g} s, steady pressure at the valve {:.5g} kPa, Darcy's friction factor "
                    "{:.4g}",
                    1e-3 * c.pipe.density * c.pipe.wave_speed * c.pipe.velocity, 4 * c.pipe.length / c.pipe.wave_speed, 1e-3 * d.steady_pressure,
                    d.friction_factor));
  add("mechanisms", (d.active.empty() ? "none" : join(d.active)) + (d.offered.empty() ? "" : "; offered to a diagnosis: " + join(d.offered)));
  std::vector<std::string> names;
  for (const auto& p : c.parameters) names.push_back(fmt::format("{} {:.4g} to {:.4g}", p.name, p.min, p.max));
  if (!names.empty()) add("parameters", join(names));
  out.notes = d.notes;
  out.summary = {{"elements", d.cells}, {"nodes", d.nodes}, {"element_steps", double(d.cells) * double(d.steps)}};
  return out;
}

SimulatorIdentity LineSimulator::identity() const {
  SimulatorIdentity out{.options = echo(), .inputs = {}, .simulate = Json::object(), .offered = Json::object()};
  for (const auto& [key, path] : files_) out.inputs[key] = hash_file(path);
  std::vector<std::string> listed;
  for (const auto& m : model_.line_case().mechanisms)
    if (m.listed) listed.push_back(m.name);
  std::sort(listed.begin(), listed.end());
  out.offered["offered"] = listed;
  return out;
}

InferenceHints LineSimulator::hints() const {
  InferenceHints h;
  h.start = InferenceHints::Start::nominal;
  h.errors = InferenceHints::Errors::no_gauges;
  const auto& stations = model_.line_case().stations;
  h.gauge_positions = Eigen::MatrixXd::Zero(Eigen::Index(stations.size()), 3);
  for (std::size_t s = 0; s < stations.size(); ++s) h.gauge_positions(Eigen::Index(s), 0) = stations[s].distance;
  return h;
}

Simulated LineSimulator::simulate(const SimulateCall& call) const {
  if (!call.fields.empty()) throw InputError({.problem = "fields are of a model on a mesh", .key = "--fields", .suggestion = "leave it out"});
  if (call.mean) throw InputError({.problem = "a line has no pulses to take a mean over", .key = "--mean", .suggestion = "leave it out"});
  const LineDescription d = model_.describe();
  std::vector<double> theta;
  for (const auto& p : shape().parameters) theta.push_back(model_.line_case().number(p.key));
  const auto start = std::chrono::steady_clock::now();
  auto prediction = model_.evaluate(theta);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!prediction.ok) throw NumericsError(prediction.message);
  const double cell_steps = double(d.cells) * double(d.steps);
  return {.values = std::move(prediction.mean),
          .summary = {{"steps", d.steps},
                      {"time_step_s", d.time_step},
                      {"wall_s", wall},
                      {"element_steps_per_s", cell_steps / wall},
                      {"energy_balance_error", nullptr},
                      {"mechanisms", d.active}},
          .steps = std::int64_t(d.steps),
          .elements = d.cells,
          .wall_s = wall,
          .element_steps_per_s = cell_steps / wall};
}

SimulatorKind line_kind() {
  return {.make = [](CaseFile& file, const SimulatorSettings&) -> std::unique_ptr<Simulator> {
            ModelOptions model;
            file.read("model", model);
            LineCase c = LineCase::read(file);
            std::map<std::string, std::filesystem::path> files;
            if (const auto drive = file.text("drive.file")) files["drive.file"] = file.resolve(*drive);
            return std::make_unique<LineSimulator>(std::move(c), std::move(files));
          },
          .tables = {"line", "drive", "time", "station", "floor"},
          .reference = line_reference,
          .catalogues = line_catalogues};
}

}  // namespace calomel
