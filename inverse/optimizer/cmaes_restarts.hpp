#pragma once
#include <pagmo/population.hpp>
#include <string>

namespace calomel {

/// Covariance matrix adaptation with restarts: pagmo's cmaes from a population of 4 + 3 ln d points (5 at least); when it has converged
/// or stagnates, it starts again at random with twice the population, until generations x population evaluations are
/// spent. Auger and Hansen 2005, A restart CMA evolution strategy with increasing population size.
struct CmaesRestarts {
  int generations = 100;
  unsigned seed = 1;
  double first_step = 0.3;   ///< sigma_0 in units of the box
  double tolerance = 1e-10;  ///< on values and on coordinates in units of the box, at which a start has converged
  [[nodiscard]] pagmo::population evolve(pagmo::population population) const;
  void set_seed(unsigned s) { seed = s; }
  [[nodiscard]] std::string get_name() const { return "CMA-ES with restarts and growing population"; }
};

}  // namespace calomel
