#include "forward/mechanism/sensor_response.hpp"

#include <cmath>
#include <numbers>

#include "forward/sensor/channel.hpp"

namespace calomel {

namespace {

void add(ObservationRow& row, const GaugeRow& more, double weight) {
  if (weight == 0) return;
  for (std::size_t i = 0; i < more.nodes.size(); ++i) {
    row.nodes.push_back(more.nodes[i]);
    row.weights.push_back({weight * more.weights[i][0], weight * more.weights[i][1], weight * more.weights[i][2]});
  }
}

/// Strain along d turned by the angle, plus k_t times the strain across: from axial, transverse and shear strain in the plane.
void turn(const MechanismValues& v, const LocatedGauge& g, ObservationRow& row) {
  const double angle = v.of(g.name, "angle") * std::numbers::pi / 180, k = v.of(g.name, "transverse");
  if (angle == 0 && k == 0) return;
  const double c = std::cos(angle), s = std::sin(angle), axial = c * c + k * s * s;
  for (auto& w : row.weights)
    for (auto& x : w) x *= axial;
  add(row, g.transverse, s * s + k * c * c);
  add(row, g.shear, (1 - k) * s * c);
}

void respond(const MechanismValues& v, const std::string& sensor, double interval, std::span<double> y) {
  const double cutoff = v.of(sensor, "low_pass"), delay = v.of(sensor, "delay"), gain = v.of(sensor, "gain"), offset = v.of(sensor, "offset");
  if (std::isfinite(cutoff)) low_pass(cutoff, interval, y);
  if (delay != 0) shift(delay, interval, y);
  if (gain != 1 || offset != 0)
    for (auto& x : y) x = gain * x + offset;
}

}  // namespace

MechanismEntry sensor_response() {
  return {.law = "gain, low pass, delay, angle, transverse part and offset of each gauge",
          .plain = "the response of the gauges",
          .check = "check calibration, amplifier, clock and orientation of the gauges",
          .keys = {{.name = "gain", .unit = "", .off = 1, .low = 0.6, .high = 1.4, .least = 0, .doc = "reading per true strain, on top of the sensor's own"},
                   {.name = "low_pass",
                    .unit = "Hz",
                    .off = std::numeric_limits<double>::infinity(),
                    .low = 10e3,
                    .high = 500e3,
                    .log_uniform = true,
                    .least = 1,
                    .doc = "-3 dB frequency of a second-order Butterworth; inf = none"},
                   {.name = "delay", .unit = "s", .off = 0, .low = -10e-6, .high = 10e-6, .doc = "by which the reading lags"},
                   {.name = "angle",
                    .unit = "deg",
                    .off = 0,
                    .low = -30,
                    .high = 30,
                    .least = -90,
                    .greatest = 90,
                    .doc = "by which the gauge is turned in its plane, from its direction towards normal x direction"},
                   {.name = "transverse",
                    .unit = "",
                    .off = 0,
                    .low = -0.05,
                    .high = 0.05,
                    .least = -1,
                    .greatest = 1,
                    .doc = "share of the strain across that it reads too"},
                   {.name = "offset", .unit = "", .off = 0, .low = -1e-4, .high = 1e-4, .doc = "added to the reading"}},
          .per_sensor = true,
          .like_the_mesh = true,
          .gauge = turn,
          .channel = respond};
}

}  // namespace calomel
