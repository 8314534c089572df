#pragma once
/// Roots of characteristic equations, and frequencies in records with several tones.
#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "base/errors.hpp"

namespace calomel::testing {

/// The root between two places of opposite sign, by bisection to the last bits.
inline double bisect(const std::function<double(double)>& f, double low, double high) {
  const bool sign = f(low) > 0;
  expect(sign != (f(high) > 0), "a root lies between the two places");
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    ((f(middle) > 0) == sign ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// All roots on a scan of `steps` intervals. A change of sign through a pole is excluded, because |f| grows there under bisection.
inline std::vector<double> roots_between(const std::function<double(double)>& f, double low, double high, int steps) {
  std::vector<double> roots;
  for (int i = 0; i < steps; ++i) {
    const double a = low + (high - low) * i / steps, b = low + (high - low) * (i + 1) / steps, fa = f(a), fb = f(b);
    if ((fa > 0) == (fb > 0)) continue;
    const double r = bisect(f, a, b);
    if (std::abs(f(r)) < std::min(std::abs(fa), std::abs(fb))) roots.push_back(r);
  }
  return roots;
}

/// Frequency [Hz] within (low, high) at which the Fourier integral of the record under a Hann window is greatest: tones four
/// or more reciprocal record lengths away do not move it.
inline double peak_frequency(std::span<const double> t, std::span<const double> y, double low, double high) {
  const double span = t.back() - t.front();
  double mean = 0;
  for (const double v : y) mean += v / double(y.size());
  const auto amplitude = [&](double f) {
    double re = 0, im = 0;
    for (std::size_t i = 0; i < t.size(); ++i) {
      const double w = (y[i] - mean) * (1 - std::cos(2 * M_PI * (t[i] - t.front()) / span));
      re += w * std::cos(2 * M_PI * f * t[i]);
      im += w * std::sin(2 * M_PI * f * t[i]);
    }
    return std::hypot(re, im);
  };
  const int scan = std::max(20, int(8 * (high - low) * span));
  const auto at = [&](int i) { return low + (high - low) * i / scan; };
  int best = 1;
  for (int i = 2; i < scan; ++i)
    if (amplitude(at(i)) > amplitude(at(best))) best = i;
  double a = at(best - 1), b = at(best + 1);
  constexpr double golden = 0.6180339887498949;
  for (int i = 0; i < 40; ++i) {
    const double p = b - golden * (b - a), q = a + golden * (b - a);
    amplitude(p) > amplitude(q) ? b = q : a = p;
  }
  return (a + b) / 2;
}

}  // namespace calomel::testing
