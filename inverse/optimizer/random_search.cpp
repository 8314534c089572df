#include "inverse/optimizer/random_search.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/random.hpp"
#include "inverse/optimizer/generation.hpp"

namespace calomel {

pagmo::population NesterovRandomSearch::evolve(pagmo::population population) const {
  const auto& problem = population.get_problem();
  const auto bounds = problem.get_bounds();
  const auto &low = bounds.first, &high = bounds.second;
  RandomStream random(seed, 0);
  Points x = population.get_x();
  auto f = values_of(population);
  const std::size_t n = x.size(), d = low.size(), count = std::max<std::size_t>(1, std::size_t(trials * double(n)));
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto i, auto j) { return f[i] < f[j]; });
  const auto moved = [&](const pagmo::vector_double& from, const std::vector<double>& u, double length) {
    auto to = from;
    for (std::size_t k = 0; k < d; ++k) to[k] = std::clamp(from[k] + length * (high[k] - low[k]) * u[k], low[k], high[k]);
    return to;
  };
  std::vector<double> h(count, 0.0);  // 0: not known yet
  std::vector<std::vector<double>> direction(count, std::vector<double>(d));
  const std::size_t iterations = std::size_t(generations) * n / (3 * count);
  for (std::size_t i = 0; i < iterations; ++i) {
    const double mu = first_mu * std::pow(last_mu / first_mu, double(i) / double(iterations));
    Points pairs;
    for (std::size_t t = 0; t < count; ++t) {
      for (auto& u : direction[t]) u = random.normal();
      for (const double sign : {1.0, -1.0}) pairs.push_back(moved(x[order[t]], direction[t], sign * mu));
    }
    const auto at = evaluate_generation(problem, pairs);
    Points next;
    for (std::size_t t = 0; t < count; ++t) {
      const double slope = (at[2 * t] - at[2 * t + 1]) / (2 * mu);
      if (h[t] == 0 && std::isfinite(slope) && slope != 0) h[t] = first_step / (std::abs(slope) * std::sqrt(double(d)));
      next.push_back(moved(x[order[t]], direction[t], std::isfinite(slope) ? std::clamp(-h[t] * slope, -1.0, 1.0) : 0));
    }
    const auto value = evaluate_generation(problem, next);
    for (std::size_t t = 0; t < count; ++t) {
      const std::size_t at_start = order[t];
      h[t] *= value[t] < f[at_start] ? grow : shrink;
      if (value[t] < f[at_start]) {
        x[at_start] = next[t];
        f[at_start] = value[t];
      }
    }
  }
  store(population, x, f);
  return population;
}

}  // namespace calomel
