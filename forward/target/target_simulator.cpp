#include "forward/target/target_simulator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "base/artefact.hpp"
#include "base/random.hpp"
#include "forward/mechanism/correction.hpp"
#include "forward/mesh/deform_mesh.hpp"
#include "forward/mesh/make_mesh.hpp"
#include "forward/mesh/mesh_extent.hpp"
#include "forward/mesh/write_mesh.hpp"
#include "forward/simulation/model_options.hpp"
#include "forward/target/correction_groups.hpp"
#include "forward/target/offered_groups.hpp"

namespace calomel {

namespace {

constexpr std::size_t most_models = 6;  ///< that are kept
constexpr double part_of_range = 0.25;  ///< of a mechanism's key, for a finite difference
constexpr double greatest_cost = 4;     ///< of a mechanism in a score test, over the base model
constexpr const char* mechanism_table = "mechanism.";

/// Enables the mechanism of "mechanism.NAME.KEY" with its default values where the case does not enable it.
void enable(ForwardCase& c, const std::string& key) {
  const std::string prefix = mechanism_table;
  if (!key.starts_with(prefix)) return;
  const std::string name = key.substr(prefix.size(), key.find('.', prefix.size()) - prefix.size());
  if (c.enables(name)) return;
  const MechanismEntry& entry = name.starts_with("correction_") ? correction() : mechanisms().get(name, key);
  c.mechanisms.push_back({name, &entry, MechanismValues(entry.keys)});
}

/// The case with elements `finer` times smaller: walls of a given number of elements keep the size of their elements.
void refine(GeometryOptions& g, double element_size, double finer) {
  g.element_size = element_size;
  g.wall_elements = int(std::lround(g.wall_elements * finer));
  g.max_elements = std::llround(double(g.max_elements) * finer * finer * finer);
}

/// The key's last word, which is the usual name of a parameter.
std::string last_word(const std::string& key) { return key.substr(key.rfind('.') + 1); }

}  // namespace

ModelShape shape_of(const ForwardCase& c) {
  ModelShape shape;
  shape.unit = c.sensor_unit;
  shape.parameters = c.parameters;
  for (const auto& condition : c.conditions) shape.conditions.push_back(condition.name);
  if (shape.conditions.empty()) shape.conditions = {"default"};
  for (const auto& s : c.sensors) shape.sensors.push_back(s.name);
  for (std::size_t k = 0; k < c.time.samples(); ++k) shape.times.push_back(double(k) * c.time.output_interval);
  return shape;
}

TargetSimulator::TargetSimulator(ForwardCase forward_case, const SimulatorSettings& settings, std::map<std::string, std::filesystem::path> files)
    : case_(std::move(forward_case)), ensemble_{.pulses = settings.pulses, .energy_sd = settings.energy_sd}, files_(std::move(files)), shape_(shape_of(case_)) {
  const bool sizes = case_.geometry.resolved().element_size.has_value();
  capabilities_ = {.meshes = sizes ? Capabilities::Meshes::sizes : Capabilities::Meshes::fixed,
                   .cheap_runs = false,
                   .pulses = true,
                   .energy_balance = true,
                   .numerics = true,
                   .strain_gauges = true,
                   .planning = true,
                   .log_density = false};
}

TargetSimulator::~TargetSimulator() = default;

TargetSimulator::Numbers TargetSimulator::numbers_of(const RunRequest& request) const {
  Numbers out;
  for (const auto& [key, value] : request.numbers) {
    const bool parameter = std::any_of(case_.parameters.begin(), case_.parameters.end(), [&, k = key](const Parameter& p) { return p.key == k; });
    if (parameter || key.starts_with("material.")) {
      out.keys.push_back(key);
      out.theta.push_back(value);
    } else {
      out.changed[key] = value;
    }
  }
  return out;
}

ForwardCase TargetSimulator::case_of(const RunRequest& r, const std::vector<std::string>& keys) const {
  ForwardCase c = case_;
  const auto own = c.geometry.resolved().element_size;
  if (r.element_size && *r.element_size > 0) {
    if (!own)
      throw InputError({.problem = "the mesh comes from a file, so it has one element size only",
                        .key = "emulator.element_sizes",
                        .suggestion = "leave it out: the emulator then works on the mesh of the file alone"});
    refine(c.geometry, *r.element_size, std::max(1.0, *own / *r.element_size));
  }
  if (r.element_size) c.mercury.least_mesh_viscosity = 0;
  if (r.refine > 1) {
    if (!own) throw InputError({.problem = "the mesh comes from a file, so there is no finer one", .key = "floor.finer_mesh"});
    refine(c.geometry, *own / r.refine, r.refine);
  }
  c.mercury.regularising_viscosity *= r.viscosity_factor;
  c.mercury.least_mesh_viscosity *= r.viscosity_factor;
  if (!r.precision.empty()) c.solver.precision = r.precision;
  c.parameters.clear();
  for (const auto& key : keys) {
    const auto known = std::find_if(case_.parameters.begin(), case_.parameters.end(), [&](const Parameter& p) { return p.key == key; });
    c.parameters.push_back(known != case_.parameters.end() ? *known : Parameter{.name = last_word(key), .key = key});
  }
  return c;
}

EnsembleOptions TargetSimulator::ensemble_of(const RunRequest& r) const {
  EnsembleOptions e = ensemble_;
  e.pulses = r.pulses.value_or(e.pulses);
  e.quantile_shift = r.energy_shift.value_or(e.quantile_shift);
  return e;
}

std::shared_ptr<const BuiltInModel> TargetSimulator::made_model(const RunRequest& request, const std::vector<std::string>& keys, int threads) const {
  ForwardCase c = case_of(request, keys);
  const EnsembleOptions energies = ensemble_of(request);
  if (!request.jitter) return std::make_shared<const BuiltInModel>(c, energies, threads);
  RandomStream random(request.jitter->seed, request.jitter->stream);
  (void)random.uniform(0.1, 0.9);  // the energy shift of the run
  Mesh moved = jittered(make_mesh(c.geometry), request.jitter->share, random);
  return std::make_shared<const BuiltInModel>(std::move(c), energies, threads, std::move(moved));
}

std::shared_ptr<const BuiltInModel> TargetSimulator::kept_model(const RunRequest& request, const std::vector<std::string>& keys, int threads) const {
  RunRequest mesh = request;
  mesh.numbers.clear();
  for (const auto& key : keys) mesh.numbers[key] = 0;
  const std::string text = fmt::format("{} on {} threads", run_text(mesh), threads);
  std::promise<Model> promise;
  const std::shared_future<Model> made = promise.get_future().share();
  {
    std::unique_lock guard(lock_);
    const auto there = std::find_if(models_.begin(), models_.end(), [&](const auto& m) { return m.first == text; });
    if (there != models_.end()) {
      const auto model = there->second;
      guard.unlock();
      return model.get();
    }
    models_.emplace_back(text, made);
    if (models_.size() > most_models) models_.pop_front();
  }
  try {
    promise.set_value(made_model(request, keys, threads));
  } catch (...) {
    promise.set_exception(std::current_exception());
  }
  return made.get();
}

std::shared_ptr<const BuiltInModel> TargetSimulator::model(int threads) const {
  std::vector<std::string> keys;
  for (const auto& p : case_.parameters) keys.push_back(p.key);
  std::sort(keys.begin(), keys.end());
  return kept_model({}, keys, threads);
}

template <class F>
auto TargetSimulator::with_model(const RunRequest& request, F&& f) const {
  const Numbers numbers = numbers_of(request);
  const auto plain = request.jitter ? made_model(request, numbers.keys, 1) : kept_model(request, numbers.keys, 1);  // a jittered mesh serves one run
  if (numbers.changed.empty()) return f(*plain, numbers.theta);
  ForwardCase changed = plain->forward_case();
  for (const auto& [key, value] : numbers.changed) {
    enable(changed, key);
    changed.set_number(key, value);
  }
  BuiltInModel own(changed, plain->ensemble(), 1);
  own.share_states_with(*plain);
  return f(own, numbers.theta);
}

Prediction TargetSimulator::evaluate(const RunRequest& request) const {
  const auto evaluate = [](const BuiltInModel& model, const std::vector<double>& theta) { return model.evaluate(theta); };
  if (numbers_of(request).changed.empty()) return with_model(request, evaluate);
  if (!request.jitter) (void)kept_model(request, numbers_of(request).keys, 1);  // an error of the case itself is no failure of a run
  try {
    return with_model(request, evaluate);
  } catch (const InputError& e) {  // a gauge off the target
    return {.ok = false, .message = e.what()};
  }
}

void TargetSimulator::add_energies(const RunRequest& request, RunRecord& record) const {
  try {
    for (const auto& t : with_model(request, [](const BuiltInModel&model, const std::vector<double>&theta) { return model.totals(theta); })) {
      record.totals.insert(record.totals.end(), {t.dissipated, t.time_at_cutoff});
      record.energy_balance.push_back(t.energy_balance_error);
    }
  } catch (const NumericsError& e) {
    record = {.message = e.what()};
  } catch (const InputError& e) {  // a parameter that leads outside what a mesh or a table allows
    record = {.message = e.what()};
  }
}

double TargetSimulator::cost(const RunRequest& r) const {
  const auto own = case_.geometry.resolved().element_size;
  const double by_size = own && r.element_size && *r.element_size > 0 ? *own / *r.element_size : 1;
  return std::pow(by_size * r.refine, 3) * (r.precision == "double" && case_.solver.precision == "single" ? 2 : 1) * (r.pulses == 1 ? 0.5 : 1);
}

std::vector<ParameterGroup> TargetSimulator::offered() const { return offered_groups(case_, model()->mesh()); }

std::vector<ParameterGroup> TargetSimulator::terms() const { return correction_groups(case_); }

SimulatorIdentity TargetSimulator::identity() const {
  SimulatorIdentity out;
  out.options = case_.echo();
  for (const char* changes_nothing : {"checkpoint", "energy_balance"}) out.options["solver"].erase(changes_nothing);
  if (out.options["solver"]["subcycles"] == 1) out.options["solver"].erase("subcycles");  // off, as in journals that were made before there were any
  Json parameters = Json::object();
  for (const auto& p : case_.parameters) {
    parameters[p.name] = {{"key", p.key}, {"min", p.min}, {"max", p.max}};
    if (p.nominal) parameters[p.name]["nominal"] = *p.nominal;
  }
  out.options["parameter"] = std::move(parameters);
  for (const auto& [key, path] : files_) out.inputs[key] = hash_file(path);
  out.simulate["solver"]["energy_balance"] = case_.solver.energy_balance;  // the summary and the checkpoint of a run hold the energies
  auto listed = case_.listed_mechanisms;
  std::sort(listed.begin(), listed.end());
  out.offered["offered"] = listed;
  return out;
}

InferenceHints TargetSimulator::hints() const {
  InferenceHints h;
  h.start = InferenceHints::Start::basin;
  h.errors = InferenceHints::Errors::strain_gauges;
  const auto number = [&](const char* name, const char* key, double value, bool logarithmic, double box, double widest) {
    h.nuisances.push_back(
        {.name = name, .key = key, .value = value, .unit = case_.about(key).unit, .logarithmic = logarithmic, .box_sds = box, .widest_sds = widest});
  };
  number("regularising_viscosity", viscosity_key, case_.mercury.regularising_viscosity, true, 1.8, 3);
  number("young", young_key, case_.steel.young, true, 2.5, 5);
  if (case_.geometry.parts() && case_.mercury.law != "linear") number("wall_film", film_key, case_.mercury.wall_film, false, 2.5, 3);
  h.numerical_viscosity = viscosity_key;
  // Relative uncertainties of mercury's density and sound speed at an operating temperature that is known to some ten kelvin, with the effect of impurities and
  // gas. The cutoff is known to a factor of two.
  h.handbook = {
      {"material.mercury.density", "normal", 0.015}, {"material.mercury.sound_speed", "normal", 0.03}, {"material.mercury.tensile_cutoff", "lognormal", 0.7}};
  for (const auto& p : case_.parameters) {
    // What a polynomial of order two follows over half a millisecond (boxes of 4.5 % of density, 6 % of sound speed and 0.6e5 to 3.6e5 Pa on the slice `null`:
    // left out, 3.6 % at 1 mm, of which 3.0 % are numerical noise).
    if (p.key == "material.mercury.density") h.half_widths[p.key] = 0.035;
    if (p.key == "material.mercury.sound_speed") h.half_widths[p.key] = 0.05;
    if (p.key == "material.mercury.tensile_cutoff") h.half_widths[p.key] = p.logarithmic() ? 0.7 : *p.nominal > 0 ? 0.6 * *p.nominal : 0.1 * (p.max - p.min);
  }
  h.element_size = case_.geometry.resolved().element_size;
  if (case_.load.kind == "initial_pressure") h.resolved_length = case_.mercury.sound_speed * case_.load.pulse_length;
  h.gauge_positions.resize(Eigen::Index(case_.sensors.size()), 3);
  for (std::size_t s = 0; s < case_.sensors.size(); ++s)
    for (std::size_t i = 0; i < 3; ++i) h.gauge_positions(Eigen::Index(s), Eigen::Index(i)) = case_.sensors[s].position[i];
  h.identified = {"material.mercury.density", "material.mercury.sound_speed", "material.mercury.tensile_cutoff"};
  h.combinations = {{"impedance rho c", {{"material.mercury.density", 1}, {"material.mercury.sound_speed", 1}}},
                    {"stiffness rho c^2", {{"material.mercury.density", 1}, {"material.mercury.sound_speed", 2}}}};
  for (const auto& key : h.identified) h.varied_numbers.push_back({.name = last_word(key), .key = key, .nominal = case_.number(key)});
  return h;
}

MeshScale TargetSimulator::mesh_scale(const RunRequest& request) const {
  const auto model = kept_model(request, numbers_of(request).keys, 1);
  const Mesh& mesh = model->mesh();
  MeshScale out{.outermost = Eigen::MatrixXd(2, 3),
                .liquid_element_size = mesh.liquid_element_size,
                .numerical_viscosity = regularising_viscosity(model->forward_case(), mesh)};
  for (int axis = 0; axis < 3; ++axis) std::tie(out.outermost(0, axis), out.outermost(1, axis)) = extent(mesh, std::size_t(axis));
  for (const auto& m : mesh.mirrors)  // a gauge may sit on the mirror image
    out.outermost(m.above ? 0 : 1, m.axis) = 2 * m.at - out.outermost(m.above ? 1 : 0, m.axis);
  if (mesh.plane_strain) out.outermost.col(1).setConstant(std::numeric_limits<double>::quiet_NaN());
  return out;
}

bool TargetSimulator::move_gauge(RunRequest& request, std::size_t sensor, double by) const {
  const SensorOptions& s = case_.sensors[sensor];
  const double length = std::hypot(s.direction[0], s.direction[1], s.direction[2]);
  for (std::size_t x = 0; x < 3; ++x) {
    if (s.direction[x] == 0) continue;
    const auto [own, absent] = request.numbers.try_emplace("sensor." + s.name + ".position." + std::to_string(x), s.position[x]);  // a parameter may hold it
    own->second += by * s.direction[x] / length;
  }
  return true;
}

std::vector<KeyDifference> TargetSimulator::score_test_keys(const RunRequest& request) const {
  const auto model = kept_model(request, numbers_of(request).keys, 1);
  std::vector<KeyDifference> all;
  for (const auto& row : mechanisms().rows()) {
    if (case_.enables(row.name) || !row.entry.built() || row.entry.cost > greatest_cost) continue;
    for (const auto& key : row.entry.keys) {
      if (!key.decides || hidden_by_mirror(key, model->mesh())) continue;
      const double off = case_.off_value(key), range = key.high - key.low;
      KeyDifference d{
          .mechanism = row.name, .key = key.name, .off = off, .low = off, .high = key.low + part_of_range * range, .like_the_mesh = row.entry.like_the_mesh};
      if (std::isfinite(off) && off >= key.low) d.high = off + part_of_range * (key.high - off);
      if (std::isfinite(off) && off > key.low) d.low = off - part_of_range * (off - key.low);
      all.push_back(std::move(d));
    }
  }
  return all;
}

std::optional<TargetView> TargetSimulator::target() const {
  const auto own = model();
  const ModelDescription d = own->describe();
  TargetView view{.owner = own, .mesh = &own->mesh(), .gauges = own->gauges(), .declared = {}, .gauge_lengths = {}, .load_policy = policy_text(case_.load)};
  for (const auto& s : case_.sensors) {
    view.declared.push_back(s.position);
    view.gauge_lengths.push_back(s.gauge_length);
  }
  view.deposited_energy = d.deposited_energy;
  view.slice_thickness = d.slice_thickness;
  view.unbuilt_mechanisms = d.notes.size();
  return view;
}

void TargetSimulator::write_mesh(const std::filesystem::path& path) const { calomel::write_mesh(model()->mesh(), path); }

SimulatorKind target_kind() {
  return {.make = [](CaseFile& file, const SimulatorSettings& settings) -> std::unique_ptr<Simulator> {
            ModelOptions model;
            file.read("model", model);
            ForwardCase c = ForwardCase::read(file);
            std::map<std::string, std::filesystem::path> files;
            for (const char* key : {"geometry.file", "load.file", "sensors"})
              if (const auto name = file.text(key)) files[key] = file.resolve(*name);
            return std::make_unique<TargetSimulator>(std::move(c), settings, std::move(files));
          },
          .tables = {"geometry", "material", "load", "time", "solver", "sensor", "sensors", "condition", "fields", "floor"},
          .reference = target_reference,
          .catalogues = target_catalogues};
}

}  // namespace calomel
