#include "inverse/optimizer/mfo.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/random.hpp"
#include "inverse/optimizer/generation.hpp"

namespace calomel {

pagmo::population MothFlame::evolve(pagmo::population population) const {
  const auto& problem = population.get_problem();
  const auto bounds = problem.get_bounds();
  const auto &low = bounds.first, &high = bounds.second;
  RandomStream random(seed, 0);
  Points moths = population.get_x(), flames;
  auto f = values_of(population);
  std::vector<double> flame_f;
  const std::size_t n = moths.size(), d = low.size();
  const auto light = [&] {  // the n best of the flames and the moths
    Points pool = flames;
    std::vector<double> value = flame_f;
    pool.insert(pool.end(), moths.begin(), moths.end());
    value.insert(value.end(), f.begin(), f.end());
    std::vector<std::size_t> order(pool.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](auto i, auto j) { return value[i] < value[j]; });
    flames.clear();
    flame_f.clear();
    for (std::size_t i = 0; i < n; ++i) flames.push_back(pool[order[i]]), flame_f.push_back(value[order[i]]);
  };
  light();
  for (int g = 0; g < generations; ++g) {
    const double share = double(g + 1) / double(generations);
    const std::size_t lit = std::max<std::size_t>(1, std::size_t(std::lround(double(n) - share * double(n - 1))));
    const double r = -1 - share;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < d; ++k) {
        const double flame = flames[std::min(i, lit - 1)][k];
        const double distance = std::abs(flames[i][k] - moths[i][k]);  // to the moth's own flame
        const double t = random.uniform(r, 1);
        moths[i][k] = std::clamp(distance * std::exp(b * t) * std::cos(2 * std::numbers::pi * t) + flame, low[k], high[k]);
      }
    f = evaluate_generation(problem, moths);
    light();
  }
  store(population, flames, flame_f);
  return population;
}

}  // namespace calomel
