#pragma once
#include <pagmo/population.hpp>
#include <string>

namespace calomel {

/// Random search of Nesterov and Spokoiny 2017 (Found. Comput. Math. 17, 527): with a Gaussian direction u, the step is
/// x <- x - h (f(x + mu u) - f(x - mu u)) / (2 mu) u. Their constant h = 1 / (4 (d + 4) L) needs the Lipschitz constant L of the gradient; here h grows
/// by `grow` when the value falls and shrinks by `shrink` when it would rise (the step is then not taken). Points are clipped
/// to the box. The best of the first population are the starts of trials that run side by side, three evaluations an iteration each.
struct NesterovRandomSearch {
  int generations = 100;
  unsigned seed = 1;
  double trials = 0.2;                     ///< share of the population that starts a trial
  double first_mu = 0.05, last_mu = 1e-4;  ///< in units of the box; falls by one factor an iteration
  double first_step = 0.1;                 ///< length of the first step, in units of the box
  double grow = 1.4, shrink = 0.8;
  [[nodiscard]] pagmo::population evolve(pagmo::population population) const;
  void set_seed(unsigned s) { seed = s; }
  [[nodiscard]] std::string get_name() const { return "Nesterov's random search"; }
};

}  // namespace calomel
