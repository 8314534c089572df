#include "apps/report/data/series.hpp"

#include <algorithm>
#include <cmath>

namespace calomel {

std::vector<double> interpolated(std::span<const double> times, std::span<const double> values, std::span<const double> at) {
  std::vector<double> out;
  out.reserve(at.size());
  if (times.empty()) return std::vector<double>(at.size(), std::nan(""));
  const double tolerance = times.size() > 1 ? 1e-6 * (times.back() - times.front()) / double(times.size() - 1) : 0;
  for (const double t : at) {
    const auto next = std::lower_bound(times.begin(), times.end(), t - tolerance);
    if (next == times.end() || t < times.front() - tolerance) {
      out.push_back(std::nan(""));
      continue;
    }
    const auto i = std::size_t(next - times.begin());
    if (std::abs(times[i] - t) <= tolerance || i == 0) {  // a time of a sample gives that sample, even where a neighbour is NaN
      out.push_back(values[i]);
      continue;
    }
    const double w = (t - times[i - 1]) / (times[i] - times[i - 1]);
    out.push_back((1 - w) * values[i - 1] + w * values[i]);
  }
  return out;
}

Thinning::Thinning(std::size_t n, std::size_t most) : n_(n) {
  if (n > most) width_ = 2 * ((n + most - 1) / most);  // samples a window; two of them are kept
}

std::vector<double> Thinning::times(std::span<const double> t) const {
  if (!active()) return {t.begin(), t.end()};
  std::vector<double> out;
  for (std::size_t b = 0; b < n_; b += width_) {
    const std::size_t n = std::min(n_ - b, width_);
    out.push_back(t[b + n / 4]);
    if (n > 1) out.push_back(t[b + 3 * n / 4]);
  }
  return out;
}

std::vector<double> Thinning::extremes(std::span<const double> values) const {
  if (!active()) return {values.begin(), values.end()};
  std::vector<double> out;
  for (std::size_t b = 0; b < n_; b += width_) {
    const std::size_t end = std::min(n_, b + width_);
    std::size_t low = n_;
    std::size_t high = n_;
    for (std::size_t i = b; i < end; ++i) {
      if (!std::isfinite(values[i])) continue;
      if (low == n_ || values[i] < values[low]) low = i;
      if (high == n_ || values[i] > values[high]) high = i;
    }
    const auto at = [&](std::size_t i) { return i == n_ ? std::nan("") : values[i]; };
    out.push_back(at(std::min(low, high)));
    if (end - b > 1) out.push_back(at(std::max(low, high)));
  }
  return out;
}

std::size_t stride(std::size_t n, std::size_t most) { return most == 0 ? n + 1 : std::max<std::size_t>(1, (n + most - 1) / most); }

}  // namespace calomel
