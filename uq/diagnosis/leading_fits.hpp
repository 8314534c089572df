#pragma once
/// Steps of a diagnosis that choose which screened candidates are fitted. Each puts its explanations into the context's library.
#include <optional>
#include <vector>

#include "uq/diagnosis/fit_library.hpp"

namespace calomel {

/// Fits what costs no runs: the gauge with the greatest evidence and the groups of many small numbers, each linearised about none.
void fit_without_runs(const FitContext& context, const std::vector<ScreenedCandidate>& screened);

/// Fits the candidates that could still lead, or compete with the leader, by their first-order evidence; where the base model does not explain the records,
/// the best candidate in any case. A candidate that the budget leaves out keeps its first-order evidence, so that nothing is named as if it had no competitor.
void fit_leaders(const FitContext& context, const std::vector<ScreenedCandidate>& screened);

/// Follows the estimates of the groups of many small numbers, in place of their fits about none. That takes the most runs, so that what could lead them is
/// fitted before.
void follow_many_small_numbers(const FitContext& context, const std::vector<ScreenedCandidate>& screened);

/// Fits a fault of one gauge beyond first order, for a low pass or a delay is far from linear in its number. The fault is linearised again until its numbers
/// remain, on the emulator of what it is added to, which knows all but this gauge. Where that does not explain the records, needs a number outside its range,
/// or the model is searched without an emulator, the fault gets a fit of its own; the better of the two is returned.
[[nodiscard]] std::optional<Alternative> fit_gauge_fault(const FitContext& context, const ParameterGroup& group, const ScreenedCandidate& screened,
                                                         const Alternative* on_top_of, double best);

}  // namespace calomel
