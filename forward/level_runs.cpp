#include "forward/level_runs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "forward/mechanism/correction.hpp"
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

namespace {

constexpr double part_of_range = 0.25;  ///< of a mechanism's key
constexpr double rounding = 1e-5;       ///< of the histories: less is what single precision leaves
constexpr double greatest_cost = 4;     ///< of a mechanism, over the base model
const std::string element_key = "geometry.element_size";

/// "mechanism.NAME.KEY" of a mechanism that the case does not enable: enables it with its default values.
void enable(ForwardCase& c, const std::string& key) {
  const std::string prefix = "mechanism.";
  if (!key.starts_with(prefix)) return;
  const std::string name = key.substr(prefix.size(), key.find('.', prefix.size()) - prefix.size());
  if (c.enables(name)) return;
  const MechanismEntry& entry = name.starts_with("correction_") ? correction() : mechanisms().get(name, key);
  c.mechanisms.push_back({name, &entry, MechanismValues(entry.keys)});
}

/// The case on a mesh of this element size: walls of a given number of elements keep their elements' size where the mesh is finer.
ForwardCase on_mesh(ForwardCase c, double element_size) {
  if (element_size == 0) return c;
  const auto own = c.geometry.resolved().element_size;
  if (!own)
    throw InputError({.problem = "the mesh comes from a file, so that there is none of another element size",
                      .key = "emulator.element_sizes",
                      .suggestion = "leave it out: the emulator then works on the mesh of the file alone"});
  const double finer = std::max(1.0, *own / element_size);
  c.geometry.element_size = element_size;
  c.geometry.wall_elements = int(std::lround(c.geometry.wall_elements * finer));
  c.geometry.max_elements = std::llround(double(c.geometry.max_elements) * finer * finer * finer);
  return c;
}

}  // namespace

LevelRuns::LevelRuns(const ForwardCase& forward_case, EnsembleOptions ensemble, std::vector<Parameter> parameters, std::vector<double> element_sizes,
                     double viscosity, RunStore& store)
    : case_(forward_case),
      ensemble_(ensemble),
      parameters_(std::move(parameters)),
      sizes_(element_sizes.rbegin(), element_sizes.rend()),
      viscosity_(viscosity),
      store_(store) {
  for (const double size : sizes_) {
    ForwardCase c = on_mesh(case_, size);
    c.parameters = parameters_;
    c.mercury.least_mesh_viscosity = 0, c.mercury.regularising_viscosity = viscosity_;
    models_.push_back(std::make_unique<BuiltInModel>(c, ensemble_, 1));
  }
}

RunPoint LevelRuns::point(std::span<const double> theta, int level) const {
  RunPoint p = point_at(parameters_, theta);
  p.insert({{element_key, sizes_[std::size_t(level)]}, {viscosity_key, viscosity_}});
  return p;
}

/// A run of the store: of a level's own model where nothing but parameters differs, of a changed case otherwise.
RunRecord LevelRuns::evaluate(const RunPoint& point) const {
  const double size = point.at(element_key);
  const auto level = std::size_t(std::find(sizes_.begin(), sizes_.end(), size) - sizes_.begin());
  expect(level < sizes_.size(), "a run is on one of the meshes");
  const auto theta = theta_at(parameters_, point);
  RunPoint rest = point;
  rest.erase(element_key), rest.erase(viscosity_key);
  for (const auto& p : parameters_) rest.erase(p.key);
  if (rest.empty()) return evaluate_run(*models_[level], theta, false);
  ForwardCase changed = models_[level]->forward_case();
  try {
    for (const auto& [key, value] : rest) enable(changed, key), changed.set_number(key, value);
    BuiltInModel own(changed, ensemble_, 1);
    own.share_states_with(*models_[level]);
    return evaluate_run(own, theta, false);
  } catch (const InputError& e) {  // a gauge off the target
    return {.message = e.what()};
  }
}

std::vector<RunRecord> LevelRuns::run(const Eigen::MatrixXd& thetas, const std::vector<int>& level, int threads, const RunStore::Progress& progress,
                                      const std::atomic<bool>* stop) {
  return run(thetas, level, {}, threads, progress, stop);
}

std::vector<RunRecord> LevelRuns::run(const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> added, int threads,
                                      const RunStore::Progress& progress, const std::atomic<bool>* stop) {
  const auto own = parameters_.size();
  expect(std::size_t(thetas.rows()) == own + added.size(), "a theta holds the parameters and what is added");
  std::vector<RunPoint> points;
  for (std::size_t i = 0; i < level.size(); ++i) {
    const auto theta = thetas.col(Eigen::Index(i));
    points.push_back(point({theta.data(), own}, level[i]));
    set_added(points.back(), {theta.data() + own, added.size()}, added);
  }
  const auto cost = [](const RunPoint& p) { return 1 / std::max(p.at(element_key), 1e-9); };
  return store_.run(
      points, [&](const RunPoint& p) { return evaluate(p); }, threads, cost, progress, stop);
}

Eigen::MatrixXd LevelRuns::gauge_places(std::span<const double> theta, double sd, int threads, const RunStore::Progress& progress,
                                        const std::atomic<bool>* stop) {
  const int level = std::min(1, levels() - 1);
  const double shift = std::max(sd, 0.5 * element_size(level));
  const ModelShape& shape = model(level).shape();
  const RunPoint base = point(theta, level);
  const auto moved = [&](RunPoint& p, const SensorOptions& s, double by) {
    const double length = std::hypot(s.direction[0], s.direction[1], s.direction[2]);
    for (std::size_t x = 0; x < 3; ++x)
      if (s.direction[x] != 0) {
        const std::string key = "sensor." + s.name + ".position." + std::to_string(x);
        const auto own = base.find(key);  // a parameter may hold it
        p[key] = (own == base.end() ? s.position[x] : own->second) + by * s.direction[x] / length;
      }
  };
  const auto run = [&](const std::vector<RunPoint>& points) {
    return store_.run(
        points, [&](const RunPoint& p) { return evaluate(p); }, threads, {}, progress, stop);
  };
  const auto sensors = shape.sensors.size();
  const auto times = Eigen::Index(shape.times.size());
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(Eigen::Index(shape.values()), Eigen::Index(sensors));
  const auto put = [&](std::size_t s, const RunRecord& up, const RunRecord& down, double apart) {
    for (std::size_t c = 0; c < shape.conditions.size(); ++c) {
      const auto at = Eigen::Index(shape.at(c, s, 0));
      directions.col(Eigen::Index(s)).segment(at, times) = sd / apart * (up.history() - down.history()).segment(at, times);
    }
  };
  std::vector<RunPoint> points(2, base);
  for (const auto& s : case_.sensors) moved(points[0], s, shift), moved(points[1], s, -shift);
  const auto all = run(points);
  if (all[0].done && all[1].done) {
    for (std::size_t s = 0; s < sensors; ++s) put(s, all[0], all[1], 2 * shift);
    return directions;
  }
  // A gauge near an edge cannot be moved beyond it: each by itself then, to one side where the other fails.
  points.assign(1, base);
  for (const auto& s : case_.sensors)
    for (const double by : {shift, -shift}) points.push_back(base), moved(points.back(), s, by);
  const auto runs = run(points);
  for (std::size_t s = 0; s < sensors; ++s) {
    const RunRecord &up = runs[1 + 2 * s], &down = runs[2 + 2 * s];
    if (up.done && down.done)
      put(s, up, down, 2 * shift);
    else if (up.done && runs[0].done)
      put(s, up, runs[0], shift);
    else if (down.done && runs[0].done)
      put(s, runs[0], down, shift);
  }
  return directions;
}

std::vector<MechanismDirections> LevelRuns::mechanisms(std::span<const double> theta, int threads, const RunStore::Progress& progress,
                                                       const std::atomic<bool>* stop) {
  /// A key between two runs; the first is the base model's where it starts at its off value.
  struct Difference {
    std::size_t mechanism;
    const MechanismKey* key;
    double off, low, high;
    std::size_t from, to;  ///< indices of the runs
  };
  const int level = std::min(1, levels() - 1);
  std::vector<const Registry<MechanismEntry>::Row*> rows;
  std::vector<Difference> differences;
  std::vector<RunPoint> points{point(theta, level)};
  for (const auto& row : calomel::mechanisms().rows()) {
    if (case_.enables(row.name) || !row.entry.built() || row.entry.cost > greatest_cost) continue;
    rows.push_back(&row);
    for (const auto& key : row.entry.keys) {
      if (!key.decides || hidden_by_mirror(key, model(level).mesh())) continue;
      const double off = case_.off_value(key), range = key.high - key.low;
      Difference d{.mechanism = rows.size() - 1, .key = &key, .off = off, .low = off, .high = key.low + part_of_range * range, .from = 0, .to = 0};
      if (std::isfinite(off) && off >= key.low) d.high = off + part_of_range * (key.high - off);
      if (std::isfinite(off) && off > key.low) d.low = off - part_of_range * (off - key.low);
      const auto with = [&](double value) {
        points.push_back(points[0]);
        points.back()["mechanism." + row.name + "." + key.name] = value;
        return points.size() - 1;
      };
      if (d.low != off) d.from = with(d.low);
      d.to = with(d.high);
      differences.push_back(d);
    }
  }
  const auto runs = store_.run(
      points, [&](const RunPoint& p) { return evaluate(p); }, threads, {}, progress, stop);
  std::vector<MechanismDirections> out;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    MechanismDirections m{.name = rows[i]->name, .like_the_mesh = rows[i]->entry.like_the_mesh};
    for (const auto& d : differences) {
      const auto &from = runs[d.from], &to = runs[d.to];
      if (d.mechanism != i || !from.done || !to.done) continue;
      const Eigen::VectorXd change = to.history() - from.history();
      if (!(change.norm() > rounding * from.history().norm())) continue;  // it cannot show here
      // An infinite value stands for none: such keys are counted by their inverse.
      const bool finite = std::isfinite(d.off);
      m.keys.push_back(finite ? d.key->name : "1/" + d.key->name), m.off.push_back(finite ? d.off : 0);
      m.directions.conservativeResize(change.size(), Eigen::Index(m.keys.size()));
      m.directions.rightCols(1) = change / (finite ? d.high - d.low : 1 / d.high - (std::isfinite(d.low) ? 1 / d.low : 0));
    }
    if (!m.keys.empty()) out.push_back(std::move(m));
  }
  return out;
}

}  // namespace calomel
