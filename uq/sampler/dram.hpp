#pragma once
/// Delayed rejection adaptive Metropolis (DRAM): Haario, Laine, Mira and Saksman 2006, DRAM: Efficient adaptive MCMC, Statistics and Computing 16, 339.
#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "base/options.hpp"
#include "uq/sampler/markov_chain.hpp"

namespace calomel {

struct SamplerEntry;  // uq/sampler/sampler_options.hpp

/// `[sampler.dram]`.
struct DramOptions {
  int stages = 2;
  double shrink = 0.2;
  int adapt_every = 100;

  template <class V>
  void visit(V& v) {
    v("stages", stages,
      {.range = between(1, 4),
       .doc = "proposals that a transition tries, each after the one before was refused; 1 is adaptive Metropolis without delayed rejection"});
    v("shrink", shrink, {.range = {.low = 0, .high = 1, .low_open = true}, .doc = "length of each stage's steps in those of the stage before"});
    v("adapt_every", adapt_every, {.range = at_least(1), .doc = "transitions of the warm-up between two changes of the proposal"});
  }
};

/// Makes a DRAM chain. Stage i proposes from N(x, g^(2 (i - 1)) C) about the chain's place x, with g = shrink and C = s (2.38^2 / d) S.
/// S is the given covariance at first, for example a Laplace approximation. In warm-up it becomes (n S_n + 2 d S') / (n + 2 d): S_n is the covariance of the
/// chain's n draws since the last but one doubling of their number, S' the estimate before that. So a poor start is forgotten and S remains positive definite.
/// s is 1 at first and follows ln s <- ln s + n^-0.6 (a - a*), with the first stage's acceptance probability a and a* = 0.234 + 0.206 / d (Andrieu and Thoms
/// 2008, Statistics and Computing 18, 343, algorithm 4). freeze() ends both adaptations, so that the kept draws are those of one reversible chain.
///
/// A transition accepts y_i of stage i with (Haario et al. 2006, equation 3; Mira 2001)
///   a_i(x, y_1..y_i) = min(1, p(y_i) prod_{j<i} q_j(y_i, y_{i-j}) (1 - a_j(y_i, y_{i-1}..y_{i-j})) / (p(x) prod_{j<i} q_j(x, y_j) (1 - a_j(x, y_1..y_j)))),
/// which leaves p invariant; the stages' own densities q_i are symmetric and cancel.
/// covariance: (d, d). Errors: InputError when it is not positive definite.
std::unique_ptr<MarkovChain> dram_chain(const LogDensity& density, const DramOptions& options, const Eigen::MatrixXd& covariance);

/// The entry of the catalogue.
SamplerEntry dram_sampler();

/// ln a_i of the path x = y_0, y_1, ..., y_i; minus infinity where a_i is 0. log_density: (i + 1); whitened: (d, i + 1), the points in coordinates in which the
/// first stage's proposal has unit covariance.
double log_delayed_acceptance(std::span<const double> log_density, const Eigen::MatrixXd& whitened, double shrink);

}  // namespace calomel
