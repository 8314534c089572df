#include "inverse/optimizer/de.hpp"

#include "base/random.hpp"
#include "inverse/optimizer/generation.hpp"

namespace calomel {

pagmo::population DifferentialEvolution::evolve(pagmo::population population) const {
  const auto& problem = population.get_problem();
  const auto bounds = problem.get_bounds();
  const auto &low = bounds.first, &high = bounds.second;
  RandomStream random(seed, 0);
  Points x = population.get_x(), trial = x;
  auto f = values_of(population);
  const std::size_t n = x.size(), d = low.size();
  for (int g = 0; g < generations; ++g) {
    for (std::size_t i = 0; i < n; ++i) {
      std::size_t a = i, b = i, c = i;
      while (a == i) a = random.below(n);
      while (b == i || b == a) b = random.below(n);
      while (c == i || c == a || c == b) c = random.below(n);
      const std::size_t always = random.below(d);
      trial[i] = x[i];
      for (std::size_t k = 0; k < d; ++k) {
        if (random.uniform() >= CR && k != always) continue;
        trial[i][k] = x[a][k] + F * (x[b][k] - x[c][k]);
        if (trial[i][k] < low[k] || trial[i][k] > high[k]) trial[i][k] = random.uniform(low[k], high[k]);
      }
    }
    const auto value = evaluate_generation(problem, trial);
    for (std::size_t i = 0; i < n; ++i)
      if (value[i] <= f[i]) {
        x[i] = trial[i];
        f[i] = value[i];
      }
  }
  store(population, x, f);
  return population;
}

}  // namespace calomel
