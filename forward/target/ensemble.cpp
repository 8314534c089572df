#include "forward/target/ensemble.hpp"

#include <boost/math/distributions/normal.hpp>
#include <cmath>

namespace calomel {

std::vector<double> pulse_energies(const EnsembleOptions& o) {
  std::vector<double> a;
  const boost::math::normal standard;
  for (int i = 0; i < o.pulses; ++i) a.push_back(o.pulses == 1 ? 1.0 : 1 + o.energy_sd * boost::math::quantile(standard, (i + o.quantile_shift) / o.pulses));
  return a;
}

void mean_over_energies(std::span<const double> pulses, Prediction& out) {
  const std::size_t m = out.energies.size(), values = pulses.size() / m;
  double mean_energy = 0, squares = 0;
  for (const double a : out.energies) mean_energy += a / double(m);
  for (const double a : out.energies) squares += (a - mean_energy) * (a - mean_energy);
  const bool slopes = out.energies.front() != out.energies.back(), scatters = m > 2;
  out.mean.assign(values, 0);
  out.energy_slope.assign(slopes ? values : 0, 0);
  out.scatter.assign(scatters ? values : 0, 0);
  for (std::size_t i = 0; i < values; ++i) {
    double mean = 0, slope = 0, rest = 0;
    for (std::size_t r = 0; r < m; ++r) mean += pulses[r * values + i] / double(m);
    if (slopes)
      for (std::size_t r = 0; r < m; ++r) slope += (out.energies[r] - mean_energy) * pulses[r * values + i] / squares;
    for (std::size_t r = 0; r < m; ++r) {
      const double d = pulses[r * values + i] - mean - slope * (out.energies[r] - mean_energy);
      rest += d * d;
    }
    out.mean[i] = mean;
    if (slopes) out.energy_slope[i] = slope;
    if (scatters) out.scatter[i] = std::sqrt(rest / double(m - 2));
  }
}

}  // namespace calomel
