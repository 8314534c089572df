#pragma once
#include <atomic>
#include <cmath>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "forward/model.hpp"
#include "inverse/data/recordings.hpp"

namespace calomel {

/// A model for tests. Every sensor shows a damped oscillation whose frequency, damping and amplitude depend on (density, sound_speed,
/// damping) differently from sensor to sensor, so that the three parameters are identifiable.
class Oscillations : public ForwardModel {
 public:
  explicit Oscillations(std::size_t n_times = 200, std::vector<std::string> sensors = {"A", "B", "C"}) {
    shape_.conditions = {"default"};
    shape_.sensors = std::move(sensors);
    for (std::size_t t = 0; t < n_times; ++t) shape_.times.push_back(double(t) * 200e-6 / double(n_times - 1));
    shape_.parameters = {parameter("density", 11000, 16000, 13500), parameter("sound_speed", 1000, 2000, 1450), parameter("damping", 0, 4e4, 1e4)};
  }
  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override {
    ++runs;
    Prediction p;
    if (fails && fails(theta)) return {.ok = false, .message = "the step collapsed"};
    for (std::size_t s = 0; s < shape_.sensors.size(); ++s) {
      const double f = theta[1] * (10 + 3 * double(s)), amplitude = error * 2.7e-8 * theta[0] / 2 * (1 + 0.3 * double(s));
      for (const double t : shape_.times) p.mean.push_back(amplitude * std::exp(-theta[2] * t) * std::sin(2 * M_PI * f * t));
    }
    return p;
  }
  double error = 1;                                    ///< factor on the amplitude, the error of a surrogate
  std::function<bool(std::span<const double>)> fails;  ///< where the model fails
  mutable std::atomic<int> runs{0};

 private:
  static Parameter parameter(const char* name, double low, double high, double nominal) {
    Parameter p;
    p.name = name;
    p.key = std::string("material.mercury.") + name;
    p.min = low;
    p.max = high;
    p.nominal = nominal;
    return p;
  }
  ModelShape shape_;
};

/// Pulses of the model at theta with independent noise.
inline Recordings recorded(const ForwardModel& model, const std::vector<double>& theta, int pulses, double noise, std::uint64_t seed) {
  const auto& shape = model.shape();
  Recordings r;
  r.conditions = shape.conditions;
  r.sensors = shape.sensors;
  r.time = shape.times;
  r.sensor_lines.assign(shape.sensors.size(), 0);
  for (int p = 0; p < pulses; ++p) r.pulses.push_back(p);
  const auto truth = model.evaluate(theta).mean;
  r.values.resize(truth.size() * std::size_t(pulses));
  RandomStream random(seed, 0);
  for (std::size_t s = 0; s < shape.sensors.size(); ++s)
    for (std::size_t p = 0; p < r.pulses.size(); ++p)
      for (std::size_t t = 0; t < r.time.size(); ++t) r.values[r.at(0, s, p, t)] = truth[shape.at(0, s, t)] + noise * random.normal();
  return r;
}

}  // namespace calomel
