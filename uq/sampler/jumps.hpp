#pragma once
/// Jumps between modes that are known beforehand.
#include <vector>

#include "uq/log_density.hpp"
#include "uq/sampler/markov_chain.hpp"
#include "uq/sampler/student.hpp"

namespace calomel {

/// The independence sampler of Metropolis (Tierney 1994, Ann. Stat. 22, 1701, section 2.3.3). Proposals y ~ g come from a mixture of Student's t about the
/// modes and are accepted with min(1, p(y) g(x) / (p(x) g(y))). The mixture never changes, so that jumps leave the density invariant in warm-up and after it.
class ModeJumps {
 public:
  explicit ModeJumps(const std::vector<StartMode>& modes) : mixture_(modes, 1) {}

  /// Lets every point of the chain try one jump. Returns the number of evaluations.
  int move(MarkovChain& chain, const LogDensity& density, RandomStream& random) const;

 private:
  StudentMixture mixture_;
};

}  // namespace calomel
