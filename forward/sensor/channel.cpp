#include "forward/sensor/channel.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace calomel {

void shift(double delay, double interval, std::span<double> y) {
  const std::vector<double> x(y.begin(), y.end());
  const auto n = std::ptrdiff_t(x.size());
  const auto at = [&](std::ptrdiff_t i) { return i < 0 ? 0.0 : x[std::size_t(std::min(i, n - 1))]; };
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    const double position = double(k) - delay / interval;
    const auto i = std::ptrdiff_t(std::floor(position));
    const double w = position - double(i);
    const double m0 = 0.5 * (at(i + 1) - at(i - 1)), m1 = 0.5 * (at(i + 2) - at(i));
    const double w2 = w * w, w3 = w2 * w;
    y[std::size_t(k)] = (2 * w3 - 3 * w2 + 1) * at(i) + (w3 - 2 * w2 + w) * m0 + (3 * w2 - 2 * w3) * at(i + 1) + (w3 - w2) * m1;
  }
}

void low_pass(double cutoff, double interval, std::span<double> y) {
  // e = y - (x - sqrt(2) x'/w) obeys the homogeneous equation while x is linear (there y = x - sqrt(2) x'/w is the forced part).
  const double w = 2 * std::numbers::pi * cutoff, h = interval, a = w / std::numbers::sqrt2;  // roots -a +- i a
  const double decay = std::exp(-a * h), c = std::cos(a * h), s = std::sin(a * h);
  double value = 0, rate = 0, before = 0;
  for (auto& sample : y) {
    const double slope = (sample - before) / h, lag = std::numbers::sqrt2 * slope / w;
    const double e = value - (before - lag), de = rate - slope;
    value = sample - lag + decay * (e * (c + s) + de * s / a);
    rate = slope + decay * (de * (c - s) - 2 * a * e * s);
    before = sample;
    sample = value;
  }
}

}  // namespace calomel
