#pragma once
/// A step of a diagnosis: the verdict on all explanations so far.
#include "uq/diagnosis/fit_library.hpp"

namespace calomel {

/// Sorts the library's candidates by their log Bayes factors, marks those that no record distinguishes, makes their hold-out predictions, and judges.
[[nodiscard]] Verdict judge_candidates(const FitContext& context);

}  // namespace calomel
