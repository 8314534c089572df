#include <pagmo/algorithms/cmaes.hpp>

#include "inverse/optimizer/cmaes_restarts.hpp"
#include "inverse/optimizer/de.hpp"
#include "inverse/optimizer/dgs.hpp"
#include "inverse/optimizer/es.hpp"
#include "inverse/optimizer/gwo.hpp"
#include "inverse/optimizer/mfo.hpp"
#include "inverse/optimizer/optimizer.hpp"
#include "inverse/optimizer/random_search.hpp"

namespace calomel {

const Registry<OptimizerEntry>& optimizers() {
  static const Registry<OptimizerEntry> all = [] {
    Registry<OptimizerEntry> r("optimiser");
    r.add("es", "self-adaptive evolution strategy (Beyer and Schwefel 2002)",
          [](int generations, unsigned seed) { return pagmo::algorithm{EvolutionStrategy{.generations = generations, .seed = seed}}; });
    r.add("gwo", "grey wolf optimiser (Mirjalili et al. 2014)",
          [](int generations, unsigned seed) { return pagmo::algorithm{GreyWolf{.generations = generations, .seed = seed}}; });
    r.add("de", "differential evolution rand/1/bin (Storn and Price 1997)",
          [](int generations, unsigned seed) { return pagmo::algorithm{DifferentialEvolution{.generations = generations, .seed = seed}}; });
    r.add("mfo", "moth-flame optimiser (Mirjalili 2015)",
          [](int generations, unsigned seed) { return pagmo::algorithm{MothFlame{.generations = generations, .seed = seed}}; });
    r.add("cmaes", "covariance matrix adaptation (Hansen 2006), pagmo's own, evaluated point by point", [](int generations, unsigned seed) {
      return pagmo::algorithm{pagmo::cmaes(unsigned(generations), -1, -1, -1, -1, 0.3, 1e-10, 1e-10, false, true, seed)};
    });
    r.add("cmaes_restarts", "cmaes started again with twice the population whenever it has converged (Auger and Hansen 2005)",
          [](int generations, unsigned seed) { return pagmo::algorithm{CmaesRestarts{.generations = generations, .seed = seed}}; });
    r.add("dgs", "gradient descent on a function smoothed along directions (Tran and Zhang 2020)", [](int generations, unsigned seed) {
      return pagmo::algorithm{DirectionalGaussianSmoothing{.generations = generations, .seed = seed, .options = {}}};
    });
    r.add("nesterov", "random search along Gaussian directions (Nesterov and Spokoiny 2017)",
          [](int generations, unsigned seed) { return pagmo::algorithm{NesterovRandomSearch{.generations = generations, .seed = seed}}; });
    return r;
  }();
  return all;
}

}  // namespace calomel
