#pragma once
/// One generation of points on a pagmo problem's box, evaluated together.
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <vector>

namespace calomel {

using Points = std::vector<pagmo::vector_double>;

/// Values of all points, in one call of the problem's batch_fitness.
inline std::vector<double> evaluate_generation(const pagmo::problem& problem, const Points& points) {
  pagmo::vector_double flat;
  flat.reserve(points.size() * points[0].size());
  for (const auto& x : points) flat.insert(flat.end(), x.begin(), x.end());
  return problem.batch_fitness(flat);
}

/// Values of a population.
inline std::vector<double> values_of(const pagmo::population& population) {
  std::vector<double> f;
  for (const auto& v : population.get_f()) f.push_back(v[0]);
  return f;
}

/// Puts points and values into the population.
inline void store(pagmo::population& population, const Points& points, const std::vector<double>& values) {
  for (std::size_t i = 0; i < points.size(); ++i) population.set_xf(i, points[i], {values[i]});
}

}  // namespace calomel
