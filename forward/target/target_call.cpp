// The verbs of a target that are not runs of the store: check's description, simulate, and the planning of an experiment.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/artefact.hpp"
#include "base/median.hpp"
#include "forward/solver/kernel.hpp"
#include "forward/target/run_fields.hpp"
#include "forward/target/target_simulator.hpp"

namespace calomel {

namespace {

constexpr double margin = 0.05;  ///< of the target's extent: a further gauge is put no nearer to an edge

std::string mechanisms_text(const ForwardCase& c) {
  const auto active = c.active_mechanisms();
  std::vector<std::string> names;
  for (const auto& m : c.mechanisms) {
    const bool off = std::none_of(active.begin(), active.end(), [&](const auto& a) { return a.name == m.name; });
    names.push_back(m.name + (off ? " (at its off values)" : ""));
  }
  return join(names);
}

std::string parameters_text(const std::vector<Parameter>& parameters) {
  std::vector<std::string> names;
  for (const auto& p : parameters) names.push_back(fmt::format("{} {:.4g} to {:.4g}", p.name, p.min, p.max));
  return join(names);
}

/// The load and, of a pulse, the deposited energy and the viscosity.
std::vector<Fact> physics_of(const LoadOptions& load, const ModelDescription& d, bool plane_strain) {
  std::vector<Fact> facts{{"load", policy_text(load)}};
  if (d.deposited_energy > 0)
    facts.push_back({"pulse", fmt::format("{:.4g} J deposited{}; regularising viscosity {:.4g} Pa s{}", d.deposited_energy,
                                          plane_strain ? fmt::format(" in a slice {:.3g} mm thick", 1e3 * d.slice_thickness) : "", d.viscosity,
                                          d.mesh_decides_viscosity ? " (decided by the mesh)" : "")});
  return facts;
}

Json finite(double x) { return std::isfinite(x) ? Json(x) : Json(); }

Json summary_of(const SolveSummary& s, bool balanced) {
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

/// The numbers of the tables, (n_parameters).
std::vector<double> table_values(const ForwardCase& c) {
  std::vector<double> theta;
  for (const auto& p : c.parameters) theta.push_back(c.number(p.key));
  return theta;
}

struct FacePlace {
  Vec3 position, direction;
};

/// Middles of outer faces that lie away from the target's edges, with the direction of a gauge there.
std::vector<FacePlace> face_middles(const Mesh& mesh) {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (const auto& f : mesh.outer)
    for (const auto n : f.nodes)
      for (std::size_t i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], mesh.nodes[std::size_t(n)][i]);
        high[i] = std::max(high[i], mesh.nodes[std::size_t(n)][i]);
      }
  std::vector<FacePlace> all;
  for (const auto& f : mesh.outer) {
    std::array<Vec3, 4> x;
    Vec3 middle{};
    for (std::size_t k = 0; k < 4; ++k) {
      x[k] = mesh.nodes[std::size_t(f.nodes[k])];
      for (std::size_t i = 0; i < 3; ++i) middle[i] += x[k][i] / 4;
    }
    const Eigen::Vector3d a(x[2][0] - x[0][0], x[2][1] - x[0][1], x[2][2] - x[0][2]), b(x[3][0] - x[1][0], x[3][1] - x[1][1], x[3][2] - x[1][2]);
    const Eigen::Vector3d normal = a.cross(b).normalized().cwiseAbs();
    if (mesh.plane_strain && normal[1] > 0.5) continue;
    bool inside = true;
    for (std::size_t i = 0; i < 3; ++i) {
      if (normal[Eigen::Index(i)] > 0.5 || (mesh.plane_strain && i == 1)) continue;
      const double share = (middle[i] - low[i]) / (high[i] - low[i]);
      inside = inside && share > margin && share < 1 - margin;
    }
    if (!inside) continue;
    if (mesh.plane_strain) middle[1] = 0;
    const bool front = normal[0] > 0.7;
    all.push_back({middle, front ? Vec3{0, 0, 1} : Vec3{1, 0, 0}});
  }
  return all;
}

/// Places on the outer surface, each as far as possible from the case's gauges and from those before it.
std::vector<FacePlace> free_places(const Mesh& mesh, const std::vector<SensorOptions>& own, int wanted) {
  const std::vector<FacePlace> all = face_middles(mesh);
  const auto distance = [](const auto& p, const auto& q) { return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]); };
  std::vector<double> nearest(all.size(), 1e300);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (const auto& s : own) nearest[i] = std::min(nearest[i], distance(all[i].position, s.position));
  std::vector<FacePlace> out;
  while (int(out.size()) < wanted && !all.empty()) {
    const auto farthest = std::size_t(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
    if (!(nearest[farthest] > 0)) break;
    out.push_back(all[farthest]);
    for (std::size_t i = 0; i < all.size(); ++i) nearest[i] = std::min(nearest[i], distance(all[i].position, out.back().position));
  }
  return out;
}

/// A run that fields.exo may follow and that may be interrupted.
Simulated simulate_once(const BuiltInModel& model, const SimulateCall& call) {
  const ForwardCase& c = model.forward_case();
  SolveOptions options = solve_options(c.solver);
  options.energy_balance = c.solver.energy_balance;
  options.threads = call.threads;
  options.stop = call.stop;
  options.on_progress = call.progress;
  const double interval = call.field_interval.value_or(c.time.end / 50);
  if (c.solver.checkpoint > 0) {
    options.checkpoint.path = call.checkpoint;
    options.checkpoint.every_seconds = c.solver.checkpoint;
    options.checkpoint.identity = fmt::format("{} {} {} fields {}", version, kernels<double>().name, call.identity, call.fields.empty() ? 0 : interval);
    if (call.fresh)
      for (const auto& path : model.checkpoints(options.checkpoint.path)) set_aside(path);
  }
  std::optional<RunFields> fields;
  if (!call.fields.empty()) fields.emplace(call.fields, model.mesh(), interval, options);
  const auto& conditions = model.shape().conditions;
  std::size_t condition = 0;  // under way
  options.checkpoint.on_resume = [&, reopen = options.checkpoint.on_resume](std::int64_t step, std::int64_t written, bool finished) {
    if (reopen && condition == 0) reopen(step, written, finished);
    if (call.resumed) call.resumed(conditions.size() > 1 ? conditions[condition] : "", step, finished);
  };
  try {
    auto run = model.simulate(options, [&](std::size_t finished) {
      if (fields && finished == 0) fields->commit();
      condition = finished + 1;
    });
    const SolveSummary& s = run.summary;
    return {.values = std::move(run.strain),
            .summary = summary_of(s, options.energy_balance),
            .steps = s.steps,
            .wall_s = s.wall_seconds,
            .element_steps_per_s = s.element_steps_per_second};
  } catch (const Interrupted&) {
    if (fields && condition == 0 && std::filesystem::exists(model.checkpoints(options.checkpoint.path).front())) fields->leave();
    throw;
  }
}

/// The mean over the pulse energies.
Simulated simulate_mean(const BuiltInModel& model, const SimulateCall& call) {
  if (!call.fields.empty())
    throw InputError({.problem = "fields are of one run, --mean is of several", .key = "--fields", .suggestion = "leave one of the two out"});
  const auto description = model.describe();
  const auto start = std::chrono::steady_clock::now();
  auto prediction = model.evaluate(table_values(model.forward_case()));
  if (!prediction.ok) throw NumericsError(prediction.message);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double runs = double(prediction.energies.size() * model.shape().conditions.size());
  const double rate = runs * double(description.elements) * double(description.steps) / wall;
  return {.values = std::move(prediction.mean),
          .summary = {{"steps", description.steps},
                      {"time_step_s", description.time_step},
                      {"subcycles", description.subcycles},
                      {"wall_s", wall},
                      {"element_steps_per_s", rate},
                      {"energy_balance_error", nullptr},
                      {"pulse_energies", prediction.energies}},
          .steps = description.steps,
          .wall_s = wall,
          .element_steps_per_s = rate};
}

}  // namespace

Description TargetSimulator::describe(int threads) const {
  const auto own = model(threads);
  const ModelDescription d = own->describe();
  const Mesh& mesh = own->mesh();
  Description out;
  const auto add = [&](const char* label, std::string text) { out.facts.push_back({label, std::move(text)}); };
  add("case",
      fmt::format("{}, {}{}{}", case_.name, case_.geometry.kind, mesh.plane_strain ? " in plane strain" : "", mesh.mirrors.empty() ? "" : ", symmetric"));
  add("model", fmt::format("{} elements, {} nodes, {} steps of {:.3g} s, {} sensors at {} times, about {:.0f} MB", d.elements, d.nodes, d.steps, d.time_step,
                           shape_.sensors.size(), shape_.times.size(), d.estimated_bytes / 1e6));
  if (shape_.conditions.size() > 1) add("conditions", join(shape_.conditions));
  if (d.subcycles > 1) add("sub-cycling", fmt::format("mercury away from the steel takes one step in {}", d.subcycles));
  out.physics = physics_of(case_.load, d, mesh.plane_strain);
  out.facts.insert(out.facts.end(), out.physics.begin(), out.physics.end());
  if (!case_.mechanisms.empty()) add("mechanisms", mechanisms_text(case_));
  const MeshQuality& q = mesh.quality;
  add("mesh",
      fmt::format("scaled Jacobian at least {:.3f}, aspect ratio at most {:.2f}, shortest edge {:.3g} mm, {} elements through the thinnest wall, wetted "
                  "faces {}",
                  q.least_scaled_jacobian, q.greatest_aspect_ratio, 1e3 * q.shortest_edge, q.least_wall_elements, case_.geometry.wetted));
  if (!case_.parameters.empty()) add("parameters", parameters_text(case_.parameters));
  out.warnings = d.warnings;
  out.notes = d.notes;
  const double conditions = double(shape_.conditions.size());
  out.cost = RunCost{.run_s = conditions * d.estimated_seconds,
                     .mean_s = conditions * d.estimated_mean_seconds,
                     .run_threads = d.run_threads,
                     .run_gain = d.run_gain,
                     .elements = d.elements,
                     .refinement_exponent = mesh.plane_strain ? 3 : 4,
                     .precision = case_.solver.precision};
  out.summary = {{"elements", d.elements},
                 {"nodes", d.nodes},
                 {"element_steps", d.element_steps},
                 {"regularising_viscosity", d.viscosity},
                 {"deposited_energy_J", d.deposited_energy}};
  return out;
}

Simulated TargetSimulator::simulate(const SimulateCall& call) const {
  const auto own = model(call.threads);
  Simulated out = call.mean ? simulate_mean(*own, call) : simulate_once(*own, call);
  out.elements = own->mesh().elements.size();
  return out;
}

std::optional<PlannedCase> TargetSimulator::planned(int gauges, const std::vector<double>& energies) const {
  PlannedCase out{.simulator = nullptr, .own_sensors = case_.sensors.size(), .gauges = {}, .energies = {}};
  ForwardCase c = case_;
  std::vector<double> lengths;
  for (const auto& s : c.sensors) lengths.push_back(s.gauge_length);
  const double usual_length = lengths.empty() ? 0 : upper_median(std::move(lengths));
  for (const auto& place : free_places(model()->mesh(), c.sensors, gauges)) {
    SensorOptions s{.name = fmt::format("new {}", out.gauges.size() + 1), .position = place.position, .direction = place.direction};
    s.gauge_length = usual_length;
    out.gauges.push_back(
        fmt::format("a gauge along {} at ({:.3g}, {:.3g}, {:.3g}) m", s.direction[0] > 0 ? "x" : "z", s.position[0], s.position[1], s.position[2]));
    c.sensors.push_back(std::move(s));
  }
  if (c.conditions.empty() && !energies.empty() && (c.load.peak_pressure || c.load.energy)) {
    const auto condition = [&](const std::string& name, double by) {
      ConditionOptions o{.name = name, .peak_pressure = {}, .energy = {}};
      if (c.load.energy)
        o.energy = by * *c.load.energy;
      else
        o.peak_pressure = by * *c.load.peak_pressure;
      c.conditions.push_back(std::move(o));
    };
    condition("as planned", 1);
    for (const double by : energies) {
      condition(fmt::format("times {:.3g}", by), by);
      out.energies.push_back(fmt::format("records at {:.3g} times the beam power as well", by));
    }
  }
  out.simulator = std::make_unique<TargetSimulator>(std::move(c), SimulatorSettings{.pulses = ensemble_.pulses, .energy_sd = ensemble_.energy_sd}, files_);
  return out;
}

}  // namespace calomel
