#include "inverse/optimizer/gwo.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/random.hpp"
#include "inverse/optimizer/generation.hpp"

namespace calomel {

pagmo::population GreyWolf::evolve(pagmo::population population) const {
  const auto& problem = population.get_problem();
  const auto bounds = problem.get_bounds();
  const auto &low = bounds.first, &high = bounds.second;
  RandomStream random(seed, 0);
  Points x = population.get_x();
  auto f = values_of(population);
  const std::size_t n = x.size(), d = low.size();
  std::array<pagmo::vector_double, 3> leader;  // alpha, beta, delta
  std::array<double, 3> leader_f;
  leader_f.fill(std::numeric_limits<double>::infinity());
  leader.fill(x[0]);
  const auto rank = [&] {
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        if (f[i] < leader_f[k]) {
          for (std::size_t m = 2; m > k; --m) leader[m] = leader[m - 1], leader_f[m] = leader_f[m - 1];
          leader[k] = x[i];
          leader_f[k] = f[i];
          break;
        }
  };
  rank();
  for (int g = 0; g < generations; ++g) {
    const double a = 2.0 * (1.0 - double(g) / double(generations));
    for (auto& wolf : x)
      for (std::size_t j = 0; j < d; ++j) {
        double sum = 0;
        for (const auto& l : leader) {
          const double A = 2 * a * random.uniform() - a, C = 2 * random.uniform();
          sum += l[j] - A * std::abs(C * l[j] - wolf[j]);
        }
        wolf[j] = std::clamp(sum / 3, low[j], high[j]);
      }
    f = evaluate_generation(problem, x);
    rank();
  }
  // The population keeps its best wolf.
  const auto worst = std::size_t(std::max_element(f.begin(), f.end()) - f.begin());
  x[worst] = leader[0];
  f[worst] = leader_f[0];
  store(population, x, f);
  return population;
}

}  // namespace calomel
