#pragma once
/// Population optimisers on a box, evaluated a whole generation at a time. All are pagmo algorithms (Biscani and Izzo
/// 2020, JOSS 5(53)): pagmo's own de, gwo and cmaes of version 2.18 evaluate point by point, so de, gwo, mfo and es are user-defined
/// algorithms here that pass each generation to the problem's batch_fitness; cmaes is pagmo's.
#include <Eigen/Core>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/registry.hpp"
#include "inverse/optimizer/pagmo_fwd.hpp"

namespace calomel {

/// Minimised function for many points at once. points: (n_parameters, n), natural units; values: (n). A failed
/// evaluation is +infinity, never NaN.
using BatchFunction = std::function<void(const Eigen::MatrixXd& points, std::span<double> values)>;

struct Bounds {
  Eigen::VectorXd low, high;  ///< (n_parameters), low < high
};

struct OptimizerOptions {
  int generations = 100;
  int population = 40;  ///< at least 5
};

struct OptimizerResult {
  Eigen::VectorXd x;          ///< best point, natural units
  double f = 0;               ///< its value
  std::vector<double> trace;  ///< (generations + 1) best value after the first population and each generation
  std::size_t evaluations = 0;
  std::size_t calls = 0;  ///< of the batch function
};

/// generations, population, seed -> algorithm. One `evolve` runs them all.
using OptimizerEntry = std::function<pagmo::algorithm(int generations, unsigned seed)>;
/// es, gwo, de, mfo, cmaes, cmaes_restarts, dgs, nesterov.
const Registry<OptimizerEntry>& optimizers();

/// Runs one algorithm from a uniform random population; the box is scaled to [0, 1] in each parameter.
/// The result depends on the arguments alone. Errors: InputError for a population below 5.
OptimizerResult minimise(const OptimizerEntry& optimizer, const BatchFunction& function, const Bounds& bounds, const OptimizerOptions& options,
                         std::uint64_t seed, std::uint64_t stream);

}  // namespace calomel
