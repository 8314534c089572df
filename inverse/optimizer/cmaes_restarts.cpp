#include "inverse/optimizer/cmaes_restarts.hpp"

#include <algorithm>
#include <cmath>
#include <pagmo/algorithms/cmaes.hpp>

#include "base/random.hpp"
#include "inverse/optimizer/generation.hpp"

namespace calomel {

pagmo::population CmaesRestarts::evolve(pagmo::population population) const {
  const auto& problem = population.get_problem();
  const auto bounds = problem.get_bounds();
  const auto &low = bounds.first, &high = bounds.second;
  RandomStream random(seed, 0);
  const std::size_t d = low.size(), budget = std::size_t(generations) * population.size();
  std::size_t spent = 0, size = std::max<std::size_t>(5, 4 + std::size_t(3 * std::log(double(d))));
  for (; spent + 2 * size <= budget; size *= 2) {
    pagmo::population start(problem, 0u, unsigned(random()));
    Points points(size, pagmo::vector_double(d));
    for (auto& x : points)
      for (std::size_t k = 0; k < d; ++k) x[k] = random.uniform(low[k], high[k]);
    const auto values = evaluate_generation(problem, points);
    spent += size;
    for (std::size_t i = 0; i < size; ++i) start.push_back(points[i], {values[i]});
    const auto before = start.get_problem().get_fevals();
    const pagmo::cmaes algorithm(unsigned((budget - spent) / size), -1, -1, -1, -1, first_step, tolerance, tolerance, false, true, unsigned(random()));
    const auto end = algorithm.evolve(start);
    spent += std::size_t(end.get_problem().get_fevals() - before);
    const auto worst = population.worst_idx(), best = end.best_idx();
    if (end.get_f()[best][0] < population.get_f()[worst][0]) population.set_xf(worst, end.get_x()[best], end.get_f()[best]);
  }
  return population;
}

}  // namespace calomel
