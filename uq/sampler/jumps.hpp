#pragma once
/// Moves between modes that are known beforehand.
#include <vector>

#include "uq/log_density.hpp"
#include "uq/sampler/markov_chain.hpp"
#include "uq/sampler/student.hpp"

namespace calomel {

/// Proposals y ~ g, a mixture of Student's t about the modes that does not depend on where a chain is, accepted with min(1, p(y) g(x) / (p(x) g(y))): the
/// independence sampler of Metropolis (Tierney 1994, Ann. Stat. 22, 1701, section 2.3.3). The mixture stays as it is, so that the density is left invariant in
/// warm-up and after it.
class ModeJumps {
 public:
  explicit ModeJumps(const std::vector<StartMode>& modes) : mixture_(modes, 1) {}

  /// Every point of the chain tries one jump; the evaluations made.
  int move(MarkovChain& chain, const LogDensity& density, RandomStream& random) const;

 private:
  StudentMixture mixture_;
};

}  // namespace calomel
