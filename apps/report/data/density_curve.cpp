#include "apps/report/data/density_curve.hpp"

#include <algorithm>
#include <cmath>

#include "uq/convergence/diagnostics.hpp"

namespace calomel {

std::vector<double> density_curve(const std::vector<double>& values, double low, double high, std::optional<double> least, std::optional<double> greatest,
                                  std::size_t points) {
  const double n = double(values.size());
  double mean = 0;
  double square = 0;
  for (const double v : values) mean += v / n;
  for (const double v : values) square += (v - mean) * (v - mean) / n;
  const double quartiles = (quantile(values, 0.75) - quantile(values, 0.25)) / 1.34;
  const double scale = quartiles > 0 ? std::min(std::sqrt(square), quartiles) : std::sqrt(square);
  const double width = std::max(0.9 * scale * std::pow(n, -0.2), 1e-3 * (high - low));
  constexpr std::size_t bins = 600;
  std::vector<double> weight(bins, 0.0);
  const double bin = (high - low) / double(bins);
  for (const double v : values)
    if (v >= low && v < high) weight[std::min(bins - 1, std::size_t((v - low) / bin))] += 1 / n;
  const auto kernel = [&](double r) { return std::exp(-0.5 * r * r / (width * width)) / (width * 2.5066282746310002); };
  std::vector<double> curve;
  for (std::size_t k = 0; k < points; ++k) {
    const double at = low + (high - low) * double(k) / double(points - 1);
    double sum = 0;
    const bool outside = (least && at < *least) || (greatest && at > *greatest);
    for (std::size_t b = 0; b < bins && !outside; ++b) {
      if (weight[b] == 0) continue;
      const double centre = low + (double(b) + 0.5) * bin;
      sum += weight[b] * kernel(at - centre);
      if (least) sum += weight[b] * kernel(at - (2 * *least - centre));
      if (greatest) sum += weight[b] * kernel(at - (2 * *greatest - centre));
    }
    curve.push_back(sum);
  }
  return curve;
}

}  // namespace calomel
