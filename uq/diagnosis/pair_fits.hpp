#pragma once
/// A step of a diagnosis: two explanations together.
#include "uq/diagnosis/fit_library.hpp"

namespace calomel {

/// Fits further explanations on top of one. Where nothing is named, that is the physics that leads, and the addition with the greatest evidence is fitted; a
/// fault of a gauge comes first only where no physics has the evidence, and second after all physics. Where physics is named, only a fault of a gauge is added,
/// which nothing that the physics leaves looks like. Returns whether anything was screened; the library has the pairs.
[[nodiscard]] bool fit_pairs(const FitContext& context, const Verdict& verdict);

}  // namespace calomel
