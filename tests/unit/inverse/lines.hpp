#pragma once
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "forward/model.hpp"
#include "inverse/data/decimation.hpp"
#include "inverse/data/recordings.hpp"

namespace calomel {

/// A model for tests: each sensor is a function of (parameters, time).
class AnalyticModel : public ForwardModel {
 public:
  using Function = std::function<double(std::span<const double> theta, double time)>;
  /// `sensors`: those of one condition after the other.
  AnalyticModel(std::vector<Parameter> parameters, std::vector<Function> sensors, std::size_t times, double step, std::string unit = "V",
                std::vector<std::string> conditions = {"default"})
      : sensors_(std::move(sensors)) {
    shape_.parameters = std::move(parameters);
    shape_.conditions = std::move(conditions);
    for (std::size_t s = 0; s < sensors_.size() / shape_.conditions.size(); ++s) shape_.sensors.push_back(fmt::format("S{}", s));
    for (std::size_t t = 0; t < times; ++t) shape_.times.push_back(double(t) * step);
    shape_.unit = std::move(unit);
  }
  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override {
    Prediction p;
    if (fails && fails(theta)) return {.ok = false, .message = "the step collapsed"};
    for (const auto& f : sensors_)
      for (const double t : shape_.times) p.mean.push_back(f(theta, t));
    return p;
  }
  std::function<bool(std::span<const double>)> fails;  ///< where the model fails

 private:
  ModelShape shape_;
  std::vector<Function> sensors_;
};

inline Parameter uniform_parameter(const std::string& name, double low, double high, double nominal) {
  Parameter p;
  p.name = name;
  p.key = "material.mercury." + name;
  p.min = low;
  p.max = high;
  p.nominal = nominal;
  return p;
}

inline Parameter normal_parameter(const std::string& name, double mean, double sd) {
  Parameter p = uniform_parameter(name, mean - 20 * sd, mean + 20 * sd, mean);
  p.prior = "normal";
  p.mean = mean;
  p.sd = sd;
  return p;
}

/// Stationary Ornstein-Uhlenbeck noise of unit variance, exact on even steps (Gillespie 1996); correlation time 0 is white noise.
inline std::vector<double> ou_noise(std::size_t n, double step, double time, RandomStream& random) {
  const double r = time > 0 ? std::exp(-step / time) : 0;
  std::vector<double> e(n);
  for (std::size_t k = 0; k < n; ++k) e[k] = k == 0 ? random.normal() : r * e[k - 1] + std::sqrt(1 - r * r) * random.normal();
  return e;
}

struct PulseRecipe {
  int pulses = 1;
  double noise = 0;
  double noise_time = 0;
  double energy_sd = 0;
  bool zeroed = false;
  double growth = 0;  ///< relative increase of the noise's sd until the end of the record
};

/// Pulses of the model at theta, with a signal proportional to the energy of the pulse.
inline Recordings pulses_of(const ForwardModel& model, const std::vector<double>& theta, const PulseRecipe& recipe, std::uint64_t seed) {
  const auto& shape = model.shape();
  Recordings r;
  r.conditions = shape.conditions;
  r.sensors = shape.sensors;
  r.time = shape.times;
  r.unit = shape.unit;
  r.sensor_lines.assign(shape.sensors.size(), 0);
  for (int p = 0; p < recipe.pulses; ++p) r.pulses.push_back(p);
  const auto truth = model.evaluate(theta).mean;
  r.values.resize(truth.size() * r.pulses.size());
  RandomStream random(seed, 0);
  const double step = shape.times[1] - shape.times[0];
  for (std::size_t p = 0; p < r.pulses.size(); ++p) {
    const double energy = 1 + recipe.energy_sd * random.normal();
    for (std::size_t i = 0; i < shape.conditions.size() * shape.sensors.size(); ++i) {
      const std::size_t c = i / shape.sensors.size(), s = i % shape.sensors.size();
      const auto e = ou_noise(shape.times.size(), step, recipe.noise_time, random);
      for (std::size_t t = 0; t < r.time.size(); ++t) {
        const auto sd = [&](std::size_t k) { return recipe.noise * (1 + recipe.growth * double(k) / double(r.time.size() - 1)); };
        r.values[r.at(c, s, p, t)] = energy * truth[shape.at(c, s, t)] + sd(t) * e[t] - (recipe.zeroed ? sd(0) * e[0] + energy * truth[shape.at(c, s, 0)] : 0);
      }
    }
  }
  return r;
}

}  // namespace calomel
