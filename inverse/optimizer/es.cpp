#include "inverse/optimizer/es.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/random.hpp"
#include "inverse/optimizer/generation.hpp"

namespace calomel {

namespace {
double reflected(double x, double low, double high) {
  const double width = high - low;
  double u = std::fmod((x - low) / width, 2.0);
  if (u < 0) u += 2;
  return low + width * (u > 1 ? 2 - u : u);
}
}  // namespace

pagmo::population EvolutionStrategy::evolve(pagmo::population population) const {
  const auto& problem = population.get_problem();
  const auto bounds = problem.get_bounds();
  const auto &low = bounds.first, &high = bounds.second;
  RandomStream random(seed, 0);
  const Points start = population.get_x();
  const auto start_f = values_of(population);
  const std::size_t lambda = start.size(), d = low.size();
  const std::size_t mu = std::clamp<std::size_t>(std::size_t(std::lround(survivors * double(lambda))), 2, lambda - 1);
  const double tau = 1 / std::sqrt(2 * std::sqrt(double(d))), tau_common = 1 / std::sqrt(2 * double(d));

  struct Individual {
    pagmo::vector_double x, s;
    double f;
  };
  const auto better = [](const Individual& a, const Individual& b) { return a.f < b.f; };
  std::vector<Individual> parents;
  for (std::size_t i = 0; i < lambda; ++i) parents.push_back({start[i], pagmo::vector_double(d, first), start_f[i]});
  std::stable_sort(parents.begin(), parents.end(), better);
  parents.resize(mu);
  for (int g = 0; g < generations; ++g) {
    std::vector<Individual> offspring;
    Points points;
    for (std::size_t i = 0; i < lambda; ++i) {
      const std::size_t p = random.below(mu);
      Individual child = parents[p];
      if (random.uniform() < cxpb) {
        std::size_t q = p;
        while (q == p) q = random.below(mu);
        for (std::size_t k = 0; k < d; ++k) {
          if (random.uniform() < 0.5) child.x[k] = parents[q].x[k];
          child.s[k] = 0.5 * (parents[p].s[k] + parents[q].s[k]);
        }
      }
      const double common = tau_common * random.normal();
      const std::size_t always = random.below(d);
      for (std::size_t k = 0; k < d; ++k) {
        if (random.uniform() >= mutpb && k != always) continue;
        child.s[k] = std::clamp(child.s[k] * std::exp(common + tau * random.normal()), smallest, largest);
        child.x[k] = reflected(child.x[k] + child.s[k] * (high[k] - low[k]) * random.normal(), low[k], high[k]);
      }
      points.push_back(child.x);
      offspring.push_back(std::move(child));
    }
    const auto f = evaluate_generation(problem, points);
    for (std::size_t i = 0; i < lambda; ++i) offspring[i].f = f[i];
    if (plus) offspring.insert(offspring.end(), parents.begin(), parents.end());
    std::stable_sort(offspring.begin(), offspring.end(), better);
    offspring.resize(mu);
    parents = std::move(offspring);
  }
  for (std::size_t i = 0; i < mu; ++i) population.set_xf(i, parents[i].x, {parents[i].f});
  return population;
}

}  // namespace calomel
