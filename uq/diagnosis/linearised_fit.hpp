#pragma once
/// A step of a diagnosis: explanations whose effect is taken for linear in their numbers, on the emulator of the fit that they are added to.
#include <optional>

#include "uq/diagnosis/fit_library.hpp"

namespace calomel {

constexpr int most_linearisations = 4;  ///< times that an effect is linearised again

/// Fits a group as one more term of the errors, beside the base model's parameters or beside `on_top_of`: about no numbers, and where it may lead `best`, the
/// greatest log Bayes factor so far, again about its estimate until that remains, `rounds` times at most. The runs are counted by the context's budget. Nothing
/// where no mode is found; the library is not changed.
[[nodiscard]] std::optional<Alternative> fit_linearised(const FitContext& context, const ParameterGroup& group, const ScreenedCandidate& screened,
                                                        const Alternative* on_top_of, double best, int rounds = most_linearisations);

}  // namespace calomel
