#pragma once
/// The sentence about the state of a posterior's chains.
#include <string>

#include "uq/convergence/assess.hpp"

namespace calomel {

/// Whether the chains have converged; if not, the worst parameter, the likely cause and what to do about it.
std::string convergence_sentence(const Convergence& convergence);

}  // namespace calomel
