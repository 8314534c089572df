#include "forward/campaign/repeatability.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/random.hpp"

namespace calomel {

namespace {

using Values = std::vector<float>;

double square(double x) { return x * x; }

/// Sums over intervals of a record of a quantity of several histories of one shape.
struct Scatter {
  double variance = 0, signal = 0;
  std::size_t samples = 0;
  void add(const std::vector<const Values*>& histories, std::size_t at) {
    double mean = 0, squares = 0;
    for (const auto* h : histories) mean += double((*h)[at]) / double(histories.size());
    for (const auto* h : histories) squares += square(double((*h)[at]) - mean);
    variance += squares / double(histories.size() - 1);
    signal += mean * mean;
    ++samples;
  }
  void add(const Scatter& part) { variance += part.variance, signal += part.signal, samples += part.samples; }
  [[nodiscard]] double relative() const { return signal > 0 ? std::sqrt(variance / signal) : 0; }
};

/// The requests that make a floor.
class FloorPlan {
 public:
  FloorPlan(const Simulator& simulator, const FloorOptions& options, std::uint64_t seed)
      : simulator_(simulator), options_(options), seed_(seed), cost_(simulator.describe().cost.value_or(RunCost{})) {}

  [[nodiscard]] bool has_finer_mesh() const {
    return options_.finer_mesh && finer_is_small_enough(options_, cost_) && simulator_.capabilities().meshes == Capabilities::Meshes::sizes;
  }
  [[nodiscard]] FloorMember member(std::size_t i) const {
    static constexpr std::array<double, 3> factors{1.0, 0.5, 2.0};
    return {.viscosity_factor = factors[i % 3], .energy_shift = RandomStream(seed_, member_stream + i).uniform(0.1, 0.9)};
  }
  [[nodiscard]] RunRequest own() const { return request_at(simulator_.shape().parameters, nominal(simulator_.shape())); }
  [[nodiscard]] RunRequest jittered(std::size_t i) const {
    const FloorMember m = member(i);
    RunRequest r = own();
    r.viscosity_factor = m.viscosity_factor;
    r.energy_shift = m.energy_shift;
    r.jitter = MeshJitter{.share = options_.mesh_jitter, .seed = seed_, .stream = member_stream + i};
    return r;
  }
  [[nodiscard]] RunRequest finer() const {
    RunRequest r = own();
    r.refine = 2;
    return r;
  }
  [[nodiscard]] RunRequest other_precision() const {
    RunRequest r = own();
    r.precision = cost_.precision == "single" ? "double" : "single";
    return r;
  }
  [[nodiscard]] RunRequest single_run(std::size_t i) const {
    const auto& own_parameters = simulator_.shape().parameters;
    const std::vector<Parameter> parameters = own_parameters.empty() ? simulator_.hints().varied_numbers : own_parameters;
    RandomStream random(seed_, single_stream + i);
    RunRequest r;
    for (const auto& p : parameters) r.numbers[p.key] = *p.nominal * (1 + options_.single_run_shift * random.uniform(-1, 1));
    r.pulses = 1;
    return r;
  }

 private:
  static constexpr std::uint64_t member_stream = 0xf100, single_stream = 0xf1000000;
  const Simulator& simulator_;
  const FloorOptions& options_;
  std::uint64_t seed_;
  RunCost cost_;
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
  for (const double r : relative) {
    worst = std::max(worst, r);
    mean += r / double(relative.size());
  }
}

}  // namespace

double floor_cost(const FloorOptions& options, int refinement_exponent, bool finer, double single_run_cost) {
  return options.members + (options.precisions || options.finer_mesh) + 1.6 * options.precisions + (finer ? std::pow(2, refinement_exponent) : 0) +
         single_run_cost * options.single_runs;
}

bool finer_is_small_enough(const FloorOptions& options, const RunCost& cost) {
  return cost.elements * (std::size_t(1) << (cost.refinement_exponent - 1)) <= std::size_t(options.finer_elements);
}

RepeatabilityFloor measure_floor(Runs& runs, const FloorOptions& options, std::uint64_t seed, const Runs::Progress& progress) {
  expect(options.members >= 3, "a scatter needs at least three members");
  const Simulator& simulator = runs.simulator();
  const FloorPlan plan(simulator, options, seed);
  const auto members = std::size_t(options.members), singles = std::size_t(options.single_runs);
  std::vector<RunRequest> requests;
  for (std::size_t i = 0; i < members; ++i) requests.push_back(plan.jittered(i));
  for (std::size_t i = 0; i < singles; ++i) requests.push_back(plan.single_run(i));
  const auto add_request = [&](const RunRequest& request) {
    requests.push_back(request);
    return requests.size() - 1;
  };
  constexpr auto none = std::size_t(-1);
  const std::size_t own_mean = options.precisions || options.finer_mesh ? add_request(plan.own()) : none;
  const std::size_t finer_mesh = plan.has_finer_mesh() ? add_request(plan.finer()) : none;
  const std::size_t other_precision = options.precisions ? add_request(plan.other_precision()) : none;
  const auto records = runs.get(requests, progress);

  RepeatabilityFloor floor;
  const ModelShape& shape = simulator.shape();
  floor.conditions = shape.conditions;
  floor.sensors = shape.sensors;
  const auto first_failure = [&](std::size_t begin, std::size_t count) {
    for (std::size_t i = begin; i < begin + count; ++i)
      if (!records[i].done) return records[i].message;
    return std::string();
  };
  std::vector<const Values*> finished, single;
  for (std::size_t i = 0; i < members; ++i) {
    const RunRecord& r = records[i];
    floor.members.push_back(plan.member(i));
    floor.members.back().ok = r.done;
    floor.members.back().message = r.message;
    if (r.done) finished.push_back(&r.mean);
  }
  if (finished.size() < 3) throw NumericsError("the repeatability floor needs three finished runs; the first failure: " + first_failure(0, members));
  add_windows(floor, shape, finished, options);
  summarise(floor.relative, floor.mean, floor.worst);

  const auto add = [&](FloorComparison c) {
    summarise(c.relative, c.mean, c.worst);
    floor.comparisons.push_back(std::move(c));
  };
  for (std::size_t i = 0; i < singles; ++i)
    if (const RunRecord& r = records[members + i]; r.done) single.push_back(&r.mean);
  if (singles > 0) {
    FloorComparison c{.name = "single_runs", .what = "scatter of single runs whose parameters differ by up to " + number_text(options.single_run_shift)};
    if (single.size() >= 2)
      c.relative = scatter(shape, single);
    else
      c.message = "fewer than two of the runs finished: " + first_failure(members, singles);
    add(std::move(c));
  }
  const auto compare = [&](const std::string& name, const std::string& what, std::size_t place, const std::string& left_out) {
    FloorComparison c{.name = name, .what = what};
    const RunRecord& own = records[own_mean];
    if (place == none)
      c.message = left_out;
    else if (const RunRecord& other = records[place]; !own.done || !other.done)
      c.message = own.done ? other.message : own.message;
    else
      c.relative = difference(shape, own.mean, other.mean);
    add(std::move(c));
  };
  if (options.finer_mesh)
    compare("finer_mesh", "ensemble mean with elements of half the size, relative L2 difference", finer_mesh,
            simulator.capabilities().meshes == Capabilities::Meshes::sizes ? "left out: that mesh would have more elements than floor.finer_elements"
                                                                           : "left out: the mesh comes from a file");
  if (options.precisions) compare("precision", "ensemble mean in single against double precision, relative L2 difference", other_precision, "");
  return floor;
}

}  // namespace calomel
