#include "forward/target/built_in_model.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/json.hpp"
#include "forward/target/effective_load.hpp"
#include "forward/target/kept_states.hpp"
#include "forward/mechanism/correction.hpp"
#include "forward/mesh/make_mesh.hpp"
#include "forward/mesh/mesh_extent.hpp"
#include "forward/sensor/channel.hpp"

namespace calomel {

namespace {

std::vector<LocatedGauge> locate_gauges(const Mesh& mesh, const std::vector<SensorOptions>& sensors) {
  const GaugeLocator locator(mesh);
  std::vector<LocatedGauge> out;
  for (std::size_t i = 0; i < sensors.size(); ++i) try {
      out.push_back(locator.locate(sensors[i]));
    } catch (const InputError& e) {
      auto parts = e.parts();
      parts.key = fmt::format("sensor[{}].{}", i, parts.key);
      throw InputError(parts);
    }
  return out;
}

Mesh mesh_of(const GeometryOptions& g) try { return make_mesh(g); } catch (const InputError& e) {
  auto parts = e.parts();
  if (parts.file.empty() && parts.key.rfind("geometry", 0) != 0) parts.key = parts.key.empty() ? "geometry" : "geometry." + parts.key;
  throw InputError(parts);
}

/// Shares of the states that earlier pulses have left; empty where there are none.
std::vector<double> left_shares(const ForwardCase& c) {
  std::vector<double> shares;
  for (const auto& m : c.active_mechanisms())
    if (m.entry->left) shares = m.entry->left(m.values);
  return shares;
}

/// Gauges are set to zero when a record begins: histories (gauge, time).
void set_to_zero(std::span<double> histories, std::size_t times) {
  for (std::size_t at = 0; at < histories.size(); at += times)
    for (std::size_t i = times; i-- > 0;) histories[at + i] -= histories[at];
}

/// What mechanisms make of the mesh.
void change_mesh(const ForwardCase& c, Mesh& mesh) {
  for (const auto& m : c.active_mechanisms()) {
    if (m.entry->mesh) try {
        m.entry->mesh(m.values, mesh);
      } catch (const InputError& e) {
        auto parts = e.parts();
        if (!parts.key.starts_with("mechanism.")) parts.key = "mechanism." + m.name + (parts.key.empty() ? "" : '.' + parts.key);
        throw InputError(parts);
      }
  }
}

std::vector<ObservationRow> observation_rows(const std::vector<LocatedGauge>& gauges, const ForwardCase& at) {
  std::vector<ObservationRow> rows;
  for (const auto& g : gauges) {
    rows.push_back({g.axial.nodes, g.axial.weights});
    for (const auto& m : at.active_mechanisms())
      if (m.entry->gauge) m.entry->gauge(m.values, g, rows.back());
  }
  return rows;
}

/// gain times what mechanisms make of x(t - delay) of the channel: the delay first, as an offset that a mechanism adds does not set in with it.
void respond(const ForwardCase& at, const SensorOptions& s, double interval, std::span<double> y) {
  if (s.delay != 0) shift(s.delay, interval, y);
  for (const auto& m : at.active_mechanisms())
    if (m.entry->channel) m.entry->channel(m.values, s.name, interval, y);
  for (auto& v : y) v *= s.gain;
}

}  // namespace

double regularising_viscosity(const ForwardCase& c, const Mesh& mesh) {
  return std::max(c.mercury.regularising_viscosity, c.mercury.least_mesh_viscosity * c.mercury.density * c.mercury.sound_speed * mesh.liquid_element_size);
}

BuiltInModel::BuiltInModel(const ForwardCase& forward_case, EnsembleOptions ensemble, int threads)
    : BuiltInModel(forward_case, ensemble, threads, mesh_of(forward_case.geometry)) {
  for (const auto& p : case_.parameters) remesh_ = remesh_ || p.key.rfind("geometry.", 0) == 0;
}

BuiltInModel::BuiltInModel(ForwardCase forward_case, EnsembleOptions ensemble, int threads, Mesh mesh)
    : case_(std::move(forward_case)),
      ensemble_(ensemble),
      threads_(threads),
      mesh_(std::make_unique<Mesh>(std::move(mesh))),
      kept_states_(std::make_shared<KeptStates>()) {
  for (const auto& p : case_.parameters)
    for (const auto& m : case_.mechanisms)
      if (m.entry->mesh && p.key.starts_with("mechanism." + m.name + '.')) unchanged_mesh_ = std::make_unique<Mesh>(*mesh_);
  if (case_.geometry.kind == "mesh") front_ = extent(*mesh_, 0).first;
  change_mesh(case_, *mesh_);
  expect_something_moves(case_, *mesh_);
  gauges_ = locate_gauges(*mesh_, case_.sensors);
  const LoadOptions load = effective_load(case_, *mesh_, front_);
  heating_ = heating_shape(*mesh_, load.profile);
  expect_heat(load, heating_, *mesh_);
  solver_ = std::make_unique<ExplicitSolver>(*mesh_, LinearElastic::from_young(case_.steel.young, case_.steel.poisson), threads);
  shape_.unit = case_.sensor_unit;
  shape_.parameters = case_.parameters;
  for (const auto& c : case_.conditions) shape_.conditions.push_back(c.name);
  if (shape_.conditions.empty()) shape_.conditions = {"default"};
  for (const auto& s : case_.sensors) shape_.sensors.push_back(s.name);
  for (std::size_t k = 0; k < case_.time.samples(); ++k) shape_.times.push_back(double(k) * case_.time.output_interval);
  for (const auto& p : case_.parameters) {
    const bool gauge = p.key.rfind("sensor.", 0) == 0 && !p.key.ends_with(".gain") && !p.key.ends_with(".delay");
    regauge_ = regauge_ || gauge;
    reheat_ = reheat_ || p.key.rfind("load.profile", 0) == 0;
    for (const auto& m : case_.mechanisms) reheat_ = reheat_ || (m.entry->load && p.key.rfind("mechanism." + m.name + '.', 0) == 0);
    resteel_ = resteel_ || p.key == "material.steel.young" || p.key == "material.steel.poisson";
  }
}
BuiltInModel::~BuiltInModel() = default;

RunSetup BuiltInModel::setup(const ForwardCase& at, const Mesh& mesh, std::size_t condition, std::vector<double> energies) const {
  RunSetup s;
  s.steel_density = at.steel.density;
  s.liquid_density = at.mercury.density;
  s.steel = LinearElastic::from_young(at.steel.young, at.steel.poisson);
  s.liquid = liquid_laws().get(at.mercury.law, "material.mercury.law")(at.mercury, regularising_viscosity(at, mesh));
  if (at.geometry.parts()) s.wetted_cutoff = s.liquid.tensile_cutoff;
  s.hourglass = at.mercury.hourglass;
  s.quadratic_viscosity = at.mercury.quadratic_viscosity;
  s.collapse_viscosity = at.mercury.collapse_viscosity;
  s.wall_film = at.mercury.wall_film;
  s.energies = std::move(energies);
  s.end = at.time.end;
  s.output_interval = at.time.output_interval;
  for (const auto& m : at.active_mechanisms())
    if (m.entry->setup) m.entry->setup(m.values, s);
  LoadOptions load = effective_load(at, mesh, front_);
  if (at.load.kind == "end_stress")
    s.end_stress = at.end_stress;
  else
    load.factor *= put_heat(s, at, mesh, load, condition);
  for (const auto& m : at.active_mechanisms())
    if (m.entry->fields) m.entry->fields(m.values, mesh, load, s);
  for (const auto& m : at.active_mechanisms()) {
    if (!m.entry->liquid) continue;
    if (s.liquid_law && m.entry != &correction())
      throw InputError({.problem = "two mechanisms replace the law of the liquid; only one can", .key = "mechanism." + m.name + ".enabled", .value = "true"});
    s.liquid_law = m.entry->liquid(m.values, s);
  }
  return s;
}

double BuiltInModel::put_heat(RunSetup& s, const ForwardCase& at, const Mesh& mesh, const LoadOptions& load, std::size_t condition) const {
  // The heat is that of the case's own liquid; with the Gruneisen policy the pressure follows the sound speed.
  const bool own = &mesh == mesh_.get() && !reheat_;
  const HeatingShape other = own ? HeatingShape{} : heating_shape(mesh, load.profile);
  const HeatingShape& heating = own ? heating_ : other;
  const auto peak_pressure = at.conditions.empty() ? load.peak_pressure : at.conditions[condition].peak_pressure;
  const auto energy = at.conditions.empty() ? load.energy : at.conditions[condition].energy;
  const double nominal_speed = case_.mercury.sound_speed, gamma = gruneisen(case_.mercury, nominal_speed);
  const auto peak_of = [&](const std::optional<double>& pressure, const std::optional<double>& heat) {
    return pressure ? *pressure : *heat * gamma / (heating.integral * symmetry_factor(mesh));
  };
  double peak = peak_of(peak_pressure, energy);
  const double own_peak = peak_of(load.peak_pressure, load.energy), strength = at.conditions.empty() || own_peak == 0 ? 1 : peak / own_peak;
  if (at.load.policy == "gruneisen") {
    const double ratio = at.mercury.sound_speed / nominal_speed;
    if (std::abs(ratio - 1) > gruneisen_reach)
      throw NumericsError(fmt::format("the gruneisen policy holds for a sound speed within 15 % of nominal ({:.5g} m/s), this is {:.5g} m/s", nominal_speed,
                                      at.mercury.sound_speed));
    peak *= gruneisen(at.mercury, at.mercury.sound_speed) / gamma;
  }
  peak *= load.factor;
  s.pulse_length = load.pulse_length;
  s.p0.resize(mesh.elements.size());
  for (std::size_t e = 0; e < s.p0.size(); ++e) s.p0[e] = peak * heating.element[e];
  s.p0_at = [profile = load.profile, peak, plane = mesh.plane_strain](const Vec3& x) { return peak * profile.shape(x, plane); };
  return strength;
}

bool BuiltInModel::start_from_what_is_left(RunSetup& s, const ForwardCase& at, const Mesh& mesh, const ExplicitSolver& solver, std::size_t condition) const {
  const std::vector<double> shares = left_shares(at);
  if (shares.empty()) return false;
  if (at.enables("bubbly_liquid"))
    throw InputError(
        {.problem =
             "what earlier pulses left holds displacements and velocities, not the sizes of bubbles, which would begin at rest in a motion that they share",
         .key = "mechanism.previous_pulses.enabled",
         .value = "true",
         .suggestion = "enable previous_pulses or bubbly_liquid, not both"});
  ForwardCase linear = at;
  linear.mercury.law = "linear";
  std::erase_if(linear.mechanisms, [](const auto& m) { return m.entry->left; });
  const auto states = kept_states_->of(fmt::format("{} {}", linear.echo().dump(), condition), [&] {
    LeftStates left(at.time.end, at.time.output_interval);
    RunSetup one = setup(linear, mesh, condition, {1.0});
    one.slip_strength.clear(), one.slip_hold.clear();
    one.end = left.end();
    one.output_interval = left.interval();
    SolveOptions options = solve_options(at.solver);
    options.threads = solver.useful_threads(one, options, threads_).threads;
    options.field_interval = left.interval();
    options.motion_alone = true;
    options.on_field = [&](const FieldSnapshot& picture) { left.take(picture); };
    (void)solver.solve(one, {}, options);
    return left.states();
  });
  LeftState sum = together(*states, shares);
  s.initial_displacement = std::move(sum.displacement);
  s.initial_velocity = std::move(sum.velocity);
  return true;
}

void BuiltInModel::share_states_with(const BuiltInModel& other) { kept_states_ = other.kept_states_; }

/// The case at some parameters with the mesh, gauges and elements that it needs: its own where a parameter changes them.
struct BuiltInModel::Place {
  ForwardCase at;
  std::unique_ptr<Mesh> own_mesh;
  std::unique_ptr<ExplicitSolver> own_solver;
  const Mesh* mesh = nullptr;
  const ExplicitSolver* solver = nullptr;
  std::vector<ObservationRow> rows;
};

std::unique_ptr<BuiltInModel::Place> BuiltInModel::at(std::span<const double> theta) const {
  auto p = std::make_unique<Place>();
  p->at = case_.at(theta);
  std::vector<LocatedGauge> own_gauges;
  // A parameter of the geometry, or of a mechanism that moves nodes, needs a mesh of its own, one of the steel's moduli its own elements.
  if (remesh_ || unchanged_mesh_) {
    p->own_mesh = std::make_unique<Mesh>(remesh_ ? mesh_of(p->at.geometry) : *unchanged_mesh_);
    change_mesh(p->at, *p->own_mesh);
  }
  p->mesh = p->own_mesh ? p->own_mesh.get() : mesh_.get();
  if (p->own_mesh || regauge_) own_gauges = locate_gauges(*p->mesh, p->at.sensors);
  if (p->own_mesh || resteel_) p->own_solver = std::make_unique<ExplicitSolver>(*p->mesh, LinearElastic::from_young(p->at.steel.young, p->at.steel.poisson));
  p->solver = p->own_solver ? p->own_solver.get() : solver_.get();
  p->rows = observation_rows(own_gauges.empty() ? gauges_ : own_gauges, p->at);
  return p;
}

Prediction BuiltInModel::evaluate(std::span<const double> theta) const {
  Prediction out;
  out.energies = pulse_energies(ensemble_);
  const std::size_t m = out.energies.size(), values = shape_.values(), times = shape_.times.size(), sensors = shape_.sensors.size();
  try {
    const auto place = this->at(theta);
    const ForwardCase& at = place->at;
    const Mesh& mesh = *place->mesh;
    const ExplicitSolver& solver = *place->solver;
    const auto& rows = place->rows;
    std::vector<double> pulses(m * values);
    for (std::size_t condition = 0; condition < shape_.conditions.size(); ++condition) {
      for (std::size_t first = 0, count = 0; first < m; first += count) {
        count = runs_at_once(m - first, mesh.plane_strain);
        RunSetup s = setup(at, mesh, condition, {out.energies.begin() + std::ptrdiff_t(first), out.energies.begin() + std::ptrdiff_t(first + count)});
        const bool moving = start_from_what_is_left(s, at, mesh, solver, condition);
        SolveOptions options = solve_options(at.solver);
        options.threads = solver.useful_threads(s, options, threads_).threads;
        SolveSummary summary = solver.solve(s, rows, options);
        expect(summary.times.size() == times, "the solver observes at every output time");
        if (moving) set_to_zero(summary.observations, times);
        for (std::size_t r = 0; r < count; ++r)
          for (std::size_t k = 0; k < sensors; ++k) {
            const auto from = summary.observations.begin() + std::ptrdiff_t((r * sensors + k) * times);
            double* to = pulses.data() + (first + r) * values + shape_.at(condition, k, 0);
            std::copy(from, from + std::ptrdiff_t(times), to);
            respond(at, at.sensors[k], at.time.output_interval, {to, times});
          }
      }
    }

    mean_over_energies(pulses, out);
    out.pulses.assign(pulses.begin(), pulses.end());
  } catch (const NumericsError& e) {
    out = Prediction{.ok = false, .message = e.what()};
  } catch (const InputError& e) {  // a parameter that leads outside what a mesh or a table allows
    out = Prediction{.ok = false, .message = e.what()};
  }
  return out;
}

std::vector<BuiltInModel::RunTotals> BuiltInModel::totals(std::span<const double> theta) const {
  const auto place = this->at(theta);
  std::vector<RunTotals> out;
  for (std::size_t condition = 0; condition < shape_.conditions.size(); ++condition) {
    RunSetup s = setup(place->at, *place->mesh, condition, {1.0});
    start_from_what_is_left(s, place->at, *place->mesh, *place->solver, condition);
    SolveOptions options = solve_options(place->at.solver);
    options.energy_balance = true;
    options.threads = place->solver->useful_threads(s, options, threads_).threads;
    const SolveSummary summary = place->solver->solve(s, place->rows, options);
    out.push_back({summary.dissipated, summary.time_at_cutoff, summary.energy_balance_error});
  }
  return out;
}

std::vector<std::filesystem::path> BuiltInModel::checkpoints(const std::filesystem::path& checkpoint) const {
  const std::size_t count = shape_.conditions.size();
  if (count == 1) return {checkpoint};
  std::vector<std::filesystem::path> paths;
  for (std::size_t condition = 0; condition < count; ++condition) paths.push_back(checkpoint.string() + '.' + std::to_string(condition));
  return paths;
}

BuiltInModel::Simulation BuiltInModel::simulate(const SolveOptions& options, const std::function<void(std::size_t condition)>& finished) const {
  Simulation out;
  SolveSummary& all = out.summary;
  const auto rows = observation_rows(gauges_, case_);
  const std::size_t times = shape_.times.size(), sensors = shape_.sensors.size(), conditions = shape_.conditions.size();
  const bool saved = !options.checkpoint.path.empty();
  const auto paths = checkpoints(options.checkpoint.path);
  double element_steps = 0;
  out.strain.resize(shape_.values());
  for (std::size_t condition = 0; condition < conditions; ++condition) {
    SolveOptions own = options;
    if (saved) own.checkpoint.path = paths[condition];
    own.checkpoint.keep = conditions > 1;
    if (options.on_progress) own.on_progress = [&](double share) { options.on_progress((double(condition) + share) / double(conditions)); };
    if (condition > 0) {
      own.field_interval = 0;
      own.checkpoint.identity += "|" + shape_.conditions[condition];
    }
    RunSetup one = setup(case_, *mesh_, condition, {1.0});
    const bool moving = start_from_what_is_left(one, case_, *mesh_, *solver_, condition);
    own.threads = solver_->useful_threads(one, own, options.threads).threads;
    SolveSummary s = solver_->solve(one, rows, own);
    if (moving) set_to_zero(s.observations, times);
    for (std::size_t k = 0; k < sensors; ++k) {
      double* to = out.strain.data() + shape_.at(condition, k, 0);
      std::copy_n(s.observations.begin() + std::ptrdiff_t(k * times), times, to);
      respond(case_, case_.sensors[k], case_.time.output_interval, {to, times});
    }
    element_steps += s.element_steps_per_second * s.wall_seconds;
    if (condition == 0) {
      all = std::move(s);
    } else {
      all.wall_seconds += s.wall_seconds;
      all.processor_seconds += s.processor_seconds;
      all.steps += s.steps;
      all.resumed_from += s.resumed_from;
      all.energy_balance_error = std::max(all.energy_balance_error, s.energy_balance_error);
      if (s.greatest_stress > all.greatest_stress) {
        all.greatest_stress = s.greatest_stress;
        all.greatest_stress_at = s.greatest_stress_at;
      }
    }
    if (finished) finished(condition);
  }
  all.element_steps_per_second = element_steps / all.wall_seconds;
  std::error_code ignored;
  if (saved)
    for (const auto& path : paths) std::filesystem::remove(path, ignored);
  return out;
}

std::unique_ptr<BuiltInModel> finer_model(const BuiltInModel& model) {
  ForwardCase c = model.forward_case();
  const auto element = c.geometry.resolved().element_size;
  if (!element) return nullptr;
  c.geometry.element_size = 0.5 * *element;
  c.geometry.wall_elements *= 2;
  c.geometry.max_elements *= 8;
  return std::make_unique<BuiltInModel>(c, model.ensemble(), 1);
}

}  // namespace calomel
