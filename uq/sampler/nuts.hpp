#pragma once
/// No-U-turn sampler: Hoffman and Gelman 2014, J. Mach. Learn. Res. 15, 1593, with the multinomial choice of a trajectory's point and the generalised criterion
/// of Betancourt 2017, arXiv:1701.02434.
#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "uq/sampler/markov_chain.hpp"

namespace calomel {

struct SamplerEntry;  // uq/sampler/sampler_options.hpp

/// `[sampler.nuts]`.
struct NutsOptions {
  double target = 0.8;
  int depth = 10;
  std::string metric = "dense";

  template <class V>
  void visit(V& v) {
    v("target", target,
      {.range = between(0.4, 0.99), .doc = "mean acceptance that the step size is tuned to; higher is slower and safer where the density bends sharply"});
    v("depth", depth, {.range = between(1, 14), .doc = "doublings of a trajectory at most"});
    v("metric", metric,
      {.doc = "covariance by which momenta are scaled, learnt in the warm-up: of all coordinates, or of each on its own, for hundreds of them",
       .choices = {"dense", "diagonal"}});
  }
};

/// The transitions of the warm-up after which a new metric begins; the first number is that from which on draws count. It is 75, then windows of 25, 50, 100,
/// ... follow, of which the last is stretched to 50 transitions before the end. In a warm-up below 150 the first and the last stretch are 15 % and 10 % of it
/// (Stan's reference manual, automatic parameter tuning). Empty below 20 transitions.
std::vector<int> warmup_windows(int warmup);

/// Makes a chain on a density with a gradient. With x = L z, L L^T = S, and momenta p ~ N(0, 1) the energy is E = -ln p(L z) + |p|^2 / 2. A transition doubles
/// its trajectory of leapfrog steps, forwards or backwards in time by a fair coin, until it or a doubled part of it turns. With rho the sum of the momenta of a
/// part and p-, p+ those of its ends, it turns where rho . p- <= 0 or rho . p+ <= 0. The same holds for a half with the nearest point of the other half
/// (Betancourt 2017, appendix A.4; the latter as in Stan 2.21). Points are drawn with weights exp(-E) and a preference for the later half (A.3.2). A trajectory
/// diverges where E has grown by more than 1000 or the density is zero; it then ends, and its last doubling is left out.
///
/// Step size: Nesterov's dual averaging (Hoffman and Gelman 2014, section 3.2) restarts with each metric from a step that is accepted half the time (algorithm
/// 4); its average holds from freeze() on. Metric: S is `covariance` at first. After each window of the warm-up it is the covariance of the window's n draws,
/// with the off-diagonal scaled by n / (n + 5 + d), so that it is positive definite; or its diagonal. covariance: (d, d); warmup: transitions that adapt.
/// Contract: the density has a gradient. Errors: InputError when the covariance is not positive definite; NumericsError where density or gradient are NaN,
/// naming the place.
std::unique_ptr<MarkovChain> nuts_chain(const LogDensity& density, const NutsOptions& options, const Eigen::MatrixXd& covariance, int warmup);

/// The entry of the catalogue.
SamplerEntry nuts_sampler();

}  // namespace calomel
