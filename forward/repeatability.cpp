#include "forward/repeatability.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/parallel.hpp"
#include "forward/mesh/deform_mesh.hpp"
#include "forward/mesh/make_mesh.hpp"

namespace calomel {

RepeatabilityFloor measure_floor(const ForwardCase& forward_case, const EnsembleOptions& ensemble, const FloorOptions& options, std::uint64_t seed, int threads,
                                 const std::function<void(std::size_t, std::size_t)>& progress, const std::atomic<bool>* stop) {
  expect(options.members >= 3, "a scatter needs at least three members");
  RepeatabilityFloor floor;
  const auto count = std::size_t(options.members);
  floor.members.resize(count);
  std::vector<std::vector<double>> means(count);
  std::mutex lock;
  std::size_t done = 0;
  ModelShape shape;
  parallel_for(count, threads, [&](std::size_t i) {
    if (stop && *stop) throw Interrupted();
    FloorMember& member = floor.members[i];
    RandomStream random(seed, 0xf100 + i);
    static constexpr std::array<double, 3> factors{1.0, 0.5, 2.0};
    member.viscosity_factor = factors[i % 3];
    member.energy_shift = random.uniform(0.1, 0.9);
    ForwardCase c = forward_case;
    c.mercury.regularising_viscosity *= member.viscosity_factor;
    c.mercury.least_mesh_viscosity *= member.viscosity_factor;
    EnsembleOptions energies = ensemble;
    energies.quantile_shift = member.energy_shift;
    const BuiltInModel model(c, energies, 1, jittered(make_mesh(c.geometry), options.mesh_jitter, random));
    Prediction p = model.evaluate(nominal(model.shape()));
    member.ok = p.ok, member.message = p.message;
    means[i] = std::move(p.mean);
    const std::lock_guard guard(lock);
    if (shape.times.empty()) shape = model.shape();
    if (progress) progress(++done, count);
  });

  std::vector<const std::vector<double>*> finished;
  for (std::size_t i = 0; i < count; ++i)
    if (floor.members[i].ok) finished.push_back(&means[i]);
  if (finished.size() < 3) throw NumericsError("the repeatability floor needs three finished runs; the first failure: " + floor.members[0].message);

  floor.conditions = shape.conditions, floor.sensors = shape.sensors;
  const double interval = forward_case.time.output_interval, end = forward_case.time.end;
  for (double begin = 0; begin < end - 0.5 * interval; begin += options.window)
    floor.window_begin.push_back(begin), floor.window_end.push_back(std::min(end, begin + options.window));
  const std::size_t windows = floor.window_begin.size(), n = finished.size();
  for (std::size_t condition = 0; condition < shape.conditions.size(); ++condition)
    for (std::size_t sensor = 0; sensor < shape.sensors.size(); ++sensor) {
      double all_variance = 0, all_signal = 0;
      for (std::size_t w = 0; w < windows; ++w) {
        double variance = 0, signal = 0;
        std::size_t samples = 0;
        for (std::size_t t = 0; t < shape.times.size(); ++t) {
          const double time = shape.times[t];
          if (time < floor.window_begin[w] - 0.25 * interval ||
              (time >= floor.window_end[w] - 0.25 * interval && !(w + 1 == windows && t + 1 == shape.times.size())))
            continue;
          double mean = 0, squares = 0;
          for (const auto* m : finished) mean += (*m)[shape.at(condition, sensor, t)] / double(n);
          for (const auto* m : finished) squares += std::pow((*m)[shape.at(condition, sensor, t)] - mean, 2);
          variance += squares / double(n - 1), signal += mean * mean, ++samples;
        }
        all_variance += variance, all_signal += signal;
        floor.sd.push_back(samples ? std::sqrt(variance / double(samples)) : 0);
        floor.signal.push_back(samples ? std::sqrt(signal / double(samples)) : 0);
      }
      floor.relative.push_back(all_signal > 0 ? std::sqrt(all_variance / all_signal) : 0);
    }
  for (const double r : floor.relative) floor.worst = std::max(floor.worst, r), floor.mean += r / double(floor.relative.size());
  return floor;
}

Json floor_json(const RepeatabilityFloor& floor) {
  Json j;
  j["mean"] = floor.mean, j["worst"] = floor.worst;
  for (const auto& m : floor.members)
    j["members"].push_back({{"viscosity_factor", m.viscosity_factor}, {"energy_shift", m.energy_shift}, {"ok", m.ok}, {"message", m.message}});
  j["window_begin_s"] = floor.window_begin, j["window_end_s"] = floor.window_end;
  const std::size_t windows = floor.window_begin.size();
  for (std::size_t c = 0, row = 0; c < floor.conditions.size(); ++c)
    for (std::size_t s = 0; s < floor.sensors.size(); ++s, ++row) {
      const auto first = std::ptrdiff_t(row * windows), last = std::ptrdiff_t((row + 1) * windows);
      j["sensors"].push_back({{"condition", floor.conditions[c]},
                              {"name", floor.sensors[s]},
                              {"relative", floor.relative[row]},
                              {"sd", std::vector<double>(floor.sd.begin() + first, floor.sd.begin() + last)},
                              {"signal", std::vector<double>(floor.signal.begin() + first, floor.signal.begin() + last)}});
    }
  return j;
}

Eigen::VectorXd floor_variance(const Json& floor, const ModelShape& shape) {
  const auto ends = floor.at("window_end_s").get<std::vector<double>>();
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(Eigen::Index(shape.values()));
  for (std::size_t c = 0; c < shape.conditions.size(); ++c)
    for (std::size_t s = 0; s < shape.sensors.size(); ++s) {
      const auto& rows = floor.at("sensors");
      const auto row = std::find_if(rows.begin(), rows.end(), [&](const Json& r) { return r.at("condition") == shape.conditions[c] && r.at("name") == shape.sensors[s]; });
      if (row == rows.end())
        throw InputError({.problem = "the repeatability floor lacks the sensor", .value = shape.sensors[s], .suggestion = "measure it anew: calomel check --floor"});
      const auto sd = row->at("sd").get<std::vector<double>>();
      for (std::size_t t = 0; t < shape.times.size(); ++t) {
        std::size_t w = 0;
        while (w + 1 < ends.size() && shape.times[t] >= ends[w] - 1e-12) ++w;
        variance[Eigen::Index(shape.at(c, s, t))] = sd.at(w) * sd.at(w);
      }
    }
  return variance;
}

}  // namespace calomel
