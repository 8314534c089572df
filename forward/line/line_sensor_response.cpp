#include "forward/line/line_sensor_response.hpp"

#include <cmath>

#include "forward/sensor/channel.hpp"

namespace calomel {

namespace {

void respond(const MechanismValues& v, const std::string& station, double interval, std::span<double> y) {
  const double lag = v.of(station, "lag"), cutoff = v.of(station, "low_pass"), gain = v.of(station, "gain");
  if (!(lag >= 0) || !(cutoff > 0)) throw NumericsError("sensor_response: a lag below 0 or a low pass that is not above 0");
  if (lag > 0) first_order_lag(lag, interval, y);
  if (std::isfinite(cutoff)) {
    const double first = y[0];
    for (auto& x : y) x -= first;
    low_pass(cutoff, interval, y);
    for (auto& x : y) x += first;
  }
  if (gain != 1)
    for (auto& x : y) x *= gain;
}

}  // namespace

void first_order_lag(double tau, double interval, std::span<double> y) {
  const double decay = std::exp(-interval / tau), mean = -std::expm1(-interval / tau) * tau / interval;
  double before = y[0], value = y[0];
  for (std::size_t i = 1; i < y.size(); ++i) {
    const double now = y[i];
    value = decay * value + (mean - decay) * before + (1 - mean) * now;
    before = now;
    y[i] = value;
  }
}

LineMechanismEntry line_sensor_response(const LineSensorRanges& r) {
  return {
      .law = "gain, lag of first order and low pass of each station",
      .keys = {{.name = "gain", .unit = "", .off = 1, .low = 0.85, .high = 1.15, .doc = "on top of the station's own"},
               {.name = "lag", .unit = "s", .off = 0, .low = r.lag_low, .high = r.lag_high, .log_uniform = true, .least = 0, .doc = "tau of tau dy/dt + y = x"},
               {.name = "low_pass",
                .unit = "Hz",
                .off = std::numeric_limits<double>::infinity(),
                .low = r.pass_low,
                .high = r.pass_high,
                .log_uniform = true,
                .least = 1e-3,
                .doc = "-3 dB frequency of a second-order Butterworth; inf = none"}},
      .per_station = true,
      .plain = "the response of the gauges",
      .check = "check calibration, amplifier, filter and clock of the gauges",
      .channel = respond};
}

}  // namespace calomel
