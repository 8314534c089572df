#include "forward/repeatability.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/parallel.hpp"
#include "forward/mesh/deform_mesh.hpp"
#include "forward/mesh/make_mesh.hpp"

namespace calomel {

namespace {

/// Numbers of the runs that are no member.
constexpr std::size_t own_mean = 100000, other_precision = 100001, finer_mesh = 100002, first_single_run = 200000;

using Values = std::vector<float>;

double square(double x) { return x * x; }

/// Sums over stretches of a record of what several histories of one shape tell at each value.
struct Scatter {
  double variance = 0, signal = 0;
  std::size_t samples = 0;
  void add(const std::vector<const Values*>& histories, std::size_t at) {
    double mean = 0, squares = 0;
    for (const auto* h : histories) mean += double((*h)[at]) / double(histories.size());
    for (const auto* h : histories) squares += square(double((*h)[at]) - mean);
    variance += squares / double(histories.size() - 1), signal += mean * mean, ++samples;
  }
  void add(const Scatter& part) { variance += part.variance, signal += part.signal, samples += part.samples; }
  [[nodiscard]] double relative() const { return signal > 0 ? std::sqrt(variance / signal) : 0; }
};

/// The runs that make a floor, each known by its number.
class FloorRuns {
 public:
  FloorRuns(const ForwardCase& forward_case, const EnsembleOptions& ensemble, const FloorOptions& options, std::uint64_t seed)
      : case_(forward_case),
        ensemble_(ensemble),
        options_(options),
        seed_(seed),
        own_(forward_case, ensemble, 1),
        single_(own_case_of_single_runs(), {.pulses = 1}, 1) {
    // The costly ones first.
    if (options.finer_mesh && finer_is_small_enough(options, own_.mesh()) && case_.geometry.resolved().element_size) places_.push_back(finer_mesh);
    if (options.precisions) places_.push_back(other_precision);
    for (int i = 0; i < options.members; ++i) places_.push_back(std::size_t(i));
    if (options.precisions || options.finer_mesh) places_.push_back(own_mean);
    for (int i = 0; i < options.single_runs; ++i) places_.push_back(first_single_run + std::size_t(i));
  }

  [[nodiscard]] const std::vector<std::size_t>& places() const { return places_; }
  [[nodiscard]] const ModelShape& shape() const { return own_.shape(); }

  [[nodiscard]] FloorMember member(std::size_t i) const {
    static constexpr std::array<double, 3> factors{1.0, 0.5, 2.0};
    return {.viscosity_factor = factors[i % 3], .energy_shift = stream(i).uniform(0.1, 0.9)};
  }

  [[nodiscard]] RunRecord run(std::size_t place) const {
    RunRecord record = place >= first_single_run  ? single_run(place - first_single_run)
                       : place == own_mean        ? at_nominal(own_)
                       : place == other_precision ? at_nominal(BuiltInModel(with_other_precision(), ensemble_, 1))
                       : place == finer_mesh      ? at_nominal(*finer_model(own_))
                                                  : jitter(place);
    return {.done = record.done, .message = std::move(record.message), .mean = std::move(record.mean)};
  }

 private:
  [[nodiscard]] RandomStream stream(std::size_t i) const { return RandomStream(seed_, 0xf100 + i); }
  [[nodiscard]] static RunRecord at_nominal(const BuiltInModel& model) { return evaluate_run(model, nominal(model.shape()), false); }

  [[nodiscard]] RunRecord jitter(std::size_t i) const {
    RandomStream random = stream(i);
    const FloorMember m = member(i);
    (void)random.uniform(0.1, 0.9);  // the member's energies
    ForwardCase c = case_;
    c.mercury.regularising_viscosity *= m.viscosity_factor;
    c.mercury.least_mesh_viscosity *= m.viscosity_factor;
    EnsembleOptions energies = ensemble_;
    energies.quantile_shift = m.energy_shift;
    return at_nominal(BuiltInModel(c, energies, 1, jittered(make_mesh(c.geometry), options_.mesh_jitter, random)));
  }

  [[nodiscard]] ForwardCase with_other_precision() const {
    ForwardCase c = case_;
    c.solver.precision = case_.solver.precision == "single" ? "double" : "single";
    return c;
  }

  /// A case without parameters has the liquid's varied.
  [[nodiscard]] ForwardCase own_case_of_single_runs() const {
    ForwardCase c = case_;
    if (c.parameters.empty())
      for (const char* name : {"density", "sound_speed", "tensile_cutoff"}) {
        const std::string key = std::string("material.mercury.") + name;
        c.parameters.push_back({.name = name, .key = key, .nominal = c.number(key)});
      }
    return c;
  }

  [[nodiscard]] RunRecord single_run(std::size_t i) const {
    RandomStream random(seed_, 0xf1000000 + i);
    auto theta = nominal(single_.shape());
    for (auto& x : theta) x *= 1 + options_.single_run_shift * random.uniform(-1, 1);
    return evaluate_run(single_, theta, false);
  }

  const ForwardCase& case_;
  const EnsembleOptions& ensemble_;
  const FloorOptions& options_;
  std::uint64_t seed_;
  BuiltInModel own_, single_;
  std::vector<std::size_t> places_;
};

/// Windows, sd and signal of the floor from the members that finished.
void add_windows(RepeatabilityFloor& floor, const ModelShape& shape, const std::vector<const Values*>& finished, const FloorOptions& options) {
  const double end = shape.times.back(), interval = shape.times.size() > 1 ? shape.times[1] - shape.times[0] : end;
  const int several = std::max(1, int(std::ceil((end - 0.5 * interval) / options.window)));
  for (int w = 0; w < several; ++w) floor.window_begin.push_back(w * options.window), floor.window_end.push_back(std::min(end, (w + 1) * options.window));
  const std::size_t windows = floor.window_begin.size();
  for (std::size_t condition = 0; condition < shape.conditions.size(); ++condition)
    for (std::size_t sensor = 0; sensor < shape.sensors.size(); ++sensor) {
      Scatter all;
      std::vector<Scatter> parts(windows);
      for (std::size_t t = 0, w = 0; t < shape.times.size(); ++t) {
        while (w + 1 < windows && shape.times[t] >= floor.window_end[w] - 0.25 * interval) ++w;
        parts[w].add(finished, shape.at(condition, sensor, t));
      }
      for (const auto& part : parts) {
        all.add(part);
        floor.sd.push_back(part.samples ? std::sqrt(part.variance / double(part.samples)) : 0);
        floor.signal.push_back(part.samples ? std::sqrt(part.signal / double(part.samples)) : 0);
      }
      floor.relative.push_back(all.relative());
    }
}

/// Calls f(first value of a record) for each record of a shape.
template <class F>
std::vector<double> by_record(const ModelShape& shape, F&& f) {
  std::vector<double> relative;
  for (std::size_t first = 0; first < shape.values(); first += shape.times.size()) relative.push_back(f(first));
  return relative;
}

std::vector<double> scatter(const ModelShape& shape, const std::vector<const Values*>& runs) {
  return by_record(shape, [&](std::size_t first) {
    Scatter scatter;
    for (std::size_t t = 0; t < shape.times.size(); ++t) scatter.add(runs, first + t);
    return scatter.relative();
  });
}

std::vector<double> difference(const ModelShape& shape, const Values& own, const Values& other) {
  return by_record(shape, [&](std::size_t first) {
    double squares = 0, signal = 0;
    for (std::size_t i = first; i < first + shape.times.size(); ++i) squares += square(double(other[i]) - double(own[i])), signal += square(own[i]);
    return signal > 0 ? std::sqrt(squares / signal) : 0;
  });
}

void summarise(const std::vector<double>& relative, double& mean, double& worst) {
  for (const double r : relative) worst = std::max(worst, r), mean += r / double(relative.size());
}

}  // namespace

double floor_cost(const FloorOptions& options, bool plane_strain, bool finer, double single_run_cost) {
  return options.members + (options.precisions || options.finer_mesh) + 1.6 * options.precisions + (finer ? plane_strain ? 8 : 16 : 0) +
         single_run_cost * options.single_runs;
}

bool finer_is_small_enough(const FloorOptions& options, const Mesh& mesh) {
  return mesh.elements.size() * (mesh.plane_strain ? 4 : 8) <= std::size_t(options.finer_elements);
}

RepeatabilityFloor measure_floor(const ForwardCase& forward_case, const EnsembleOptions& ensemble, const FloorOptions& options, std::uint64_t seed, int threads,
                                 const FloorWatch& watch) {
  expect(options.members >= 3, "a scatter needs at least three members");
  const FloorRuns runs(forward_case, ensemble, options, seed);
  std::map<std::size_t, RunRecord> records;
  std::mutex lock;
  std::size_t done = 0;
  parallel_for(runs.places().size(), threads, [&](std::size_t i) {
    if (watch.stop && *watch.stop) throw Interrupted();
    const std::size_t place = runs.places()[i];
    const RunPoint point{{"floor.run", double(place)}};
    RunRecord record = watch.store ? watch.store
                                         ->run(
                                             {&point, 1}, [&](const RunPoint&) { return runs.run(place); }, 1)
                                         .front()
                                   : runs.run(place);
    const std::lock_guard guard(lock);
    records[place] = std::move(record);
    if (watch.progress) watch.progress(++done, runs.places().size());
  });

  RepeatabilityFloor floor;
  const ModelShape& shape = runs.shape();
  floor.conditions = shape.conditions, floor.sensors = shape.sensors;
  const auto first_failure = [&](std::size_t begin, int count) {
    for (std::size_t i = begin; i < begin + std::size_t(count); ++i)
      if (!records.at(i).done) return records.at(i).message;
    return std::string();
  };
  std::vector<const Values*> finished, single;
  for (std::size_t i = 0; i < std::size_t(options.members); ++i) {
    const RunRecord& r = records.at(i);
    floor.members.push_back(runs.member(i));
    floor.members.back().ok = r.done, floor.members.back().message = r.message;
    if (r.done) finished.push_back(&r.mean);
  }
  if (finished.size() < 3) throw NumericsError("the repeatability floor needs three finished runs; the first failure: " + first_failure(0, options.members));
  add_windows(floor, shape, finished, options);
  summarise(floor.relative, floor.mean, floor.worst);

  const auto add = [&](FloorComparison c) {
    summarise(c.relative, c.mean, c.worst);
    floor.comparisons.push_back(std::move(c));
  };
  for (std::size_t i = 0; i < std::size_t(options.single_runs); ++i)
    if (const RunRecord& r = records.at(first_single_run + i); r.done) single.push_back(&r.mean);
  if (options.single_runs > 0) {
    FloorComparison c{.name = "single_runs", .what = "scatter of single runs whose parameters differ by up to " + number_text(options.single_run_shift)};
    if (single.size() >= 2)
      c.relative = scatter(shape, single);
    else
      c.message = "fewer than two of the runs finished: " + first_failure(first_single_run, options.single_runs);
    add(std::move(c));
  }
  const auto compare = [&](const std::string& name, const std::string& what, std::size_t place, const std::string& left_out) {
    FloorComparison c{.name = name, .what = what};
    const RunRecord& own = records.at(own_mean);
    if (!records.contains(place))
      c.message = left_out;
    else if (const RunRecord& other = records.at(place); !own.done || !other.done)
      c.message = own.done ? other.message : own.message;
    else
      c.relative = difference(shape, own.mean, other.mean);
    add(std::move(c));
  };
  if (options.finer_mesh)
    compare("finer_mesh", "ensemble mean with elements of half the size, relative L2 difference", finer_mesh,
            forward_case.geometry.resolved().element_size ? "left out: that mesh would have more elements than floor.finer_elements"
                                                          : "left out: the mesh comes from a file");
  if (options.precisions) compare("precision", "ensemble mean in single against double precision, relative L2 difference", other_precision, "");
  return floor;
}

}  // namespace calomel
