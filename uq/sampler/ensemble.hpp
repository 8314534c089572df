#pragma once
/// Ensembles of walkers that propose by one another's places: stretch moves (Goodman and Weare 2010, Comm. Appl. Math. Comp. Sci. 5, 65) and moves of
/// differential evolution (ter Braak 2006, Statistics and Computing 16, 239).
#include <Eigen/Core>
#include <memory>

#include "base/options.hpp"
#include "uq/sampler/markov_chain.hpp"

namespace calomel {

struct SamplerEntry;  // uq/sampler/sampler_options.hpp

/// `[sampler.ensemble]`.
struct WalkerOptions {
  int walkers = 0;
  double stretch = 0.5;
  double scale = 2;

  template <class V>
  void visit(V& v) {
    v("walkers", walkers,
      {.range = between(0, 100000),
       .doc = "of each ensemble, an even number of at least twice the parameters; 0: four times the parameters, 8 or more. Each is a chain of the output"});
    v("stretch", stretch,
      {.range = between(0, 1),
       .doc = "share of stretch moves; the others are differences of two other walkers, which alone leave one behind that starts far off"});
    v("scale", scale, {.range = {.low = 1, .high = 100, .low_open = true}, .doc = "greatest stretch a; the least is 1/a"});
  }
};

/// The number of walkers of an ensemble on d coordinates. Errors: InputError when it is odd or too small.
[[nodiscard]] std::size_t walkers_of(const WalkerOptions& options, std::size_t d);

/// Makes W walkers in two halves. A transition moves each walker k once, by walkers of the other half, which do not move meanwhile:
///  - stretch: y = x_j + z (x_k - x_j), z with the density ~ 1 / sqrt(z) on [1/a, a], accepted with min(1, z^(d - 1) p(y) / p(x_k));
///  - difference: y = x_k + g (x_i - x_j), g = 2.38 / sqrt(2 d) times N(1, 0.1), or 1 in one move of ten, which carries walkers between modes; accepted with
///    min(1, p(y) / p(x_k)).
/// Both moves leave the product of the walkers' densities invariant and are the same under an affine map. Nothing is adapted in the warm-up. Walkers start
/// about `mean`, `dispersion` times as wide as `covariance`. Errors: InputError when the covariance is not positive definite, or the number of walkers is odd
/// or too small; NumericsError where the density is NaN, or zero at all trial starts of a walker.
std::unique_ptr<MarkovChain> ensemble_chain(const LogDensity& density, const WalkerOptions& options, const Eigen::VectorXd& mean,
                                            const Eigen::MatrixXd& covariance, double dispersion);

/// The entry of the catalogue.
SamplerEntry ensemble_sampler();

}  // namespace calomel
