#pragma once
/// Sequential Monte Carlo through tempered densities: Del Moral, Doucet and Jasra 2006, Journal of the Royal Statistical Society B 68, 411.
#include <Eigen/Core>
#include <memory>

#include "base/options.hpp"
#include "uq/sampler/markov_chain.hpp"
#include "uq/sampler/start.hpp"

namespace calomel {

struct SamplerEntry;  // uq/sampler/sampler_options.hpp

/// `[sampler.smc]`.
struct SmcOptions {
  double keep = 0.9;
  double correlation = 0.6;
  int sweeps = 200;
  int evaluations = 1'000'000;

  template <class V>
  void visit(V& v) {
    v("keep", keep,
      {.range = between(0.1, 0.999),
       .doc = "conditional effective sample size after a step of the temperature, as a share of the particles; nearer to 1 takes more steps and gives a more "
              "precise evidence"});
    v("correlation", correlation,
      {.range = between(0.01, 0.99), .doc = "particles move at each temperature until no coordinate's places correlate more than this with those before"});
    v("sweeps", sweeps, {.range = at_least(1), .doc = "moves of each particle at a temperature at most"});
    v("evaluations", evaluations,
      {.range = at_least(1),
       .doc = "greatest number of evaluations of the density for one population. If the particles hardly move, the call ends there (exit status 3); with a "
              "larger number the same command resumes"});
  }
};

/// Makes a population of N particles that goes from q to p through the tempered densities
///   p_b(x) ~ q(x)^(1 - b) p(x)^b,  0 = b_0 < b_1 < ... = 1.
/// q is a mixture, by the modes' weights, of Student's t with 4 degrees of freedom about each mode and the scale `dispersion`^2 times its covariance. Weights
/// grow by w = (p / q)^(b_k - b_(k-1)). b_k is chosen so that the conditional effective sample size N (sum W w)^2 / sum W w^2, W the weights before, is keep N
/// (Zhou, Johansen and Aston 2016, J. Comput. Graph. Stat. 25, 701, equation 3.14). ln Z = sum_k ln sum W w estimates the evidence, the integral of p over its
/// coordinates. The population is resampled systematically where 1 / sum W^2 falls below N / 2, and at b = 1. At each temperature every particle makes steps of
/// Metropolis with the particles' own covariance, s (2.38^2 / d) S, until the correlation with the places before is small; s follows the acceptance 0.234 +
/// 0.206 / d from sweep to sweep. With several modes, each part of q (the places where it is the likeliest) has its own S and s. Steps out of a part are
/// refused and correlations are taken within the parts, so that the weights alone carry the modes' shares.
///
/// The warm-up draws the particles and makes one sweep in each transition until b = 1; missing sweeps are made before the first draw. Afterwards each
/// transition returns one particle, N in all, in the order of descent. Systematic resampling keeps the offspring of a particle side by side, so that what
/// relatives still share appears as an autocorrelation of the draws. Chains are independent populations, whose evidences give its standard error. particles: N.
/// Errors: InputError when a covariance is not positive definite; NumericsError where the density is NaN, where it is zero at all particles of q, and where
/// `evaluations` are used up before b = 1.
std::unique_ptr<MarkovChain> smc_chain(const LogDensity& density, const SmcOptions& options, const std::vector<StartMode>& modes, double dispersion,
                                       std::size_t particles);

/// The entry of the catalogue.
SamplerEntry smc_sampler();

}  // namespace calomel
