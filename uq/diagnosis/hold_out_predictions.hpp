#pragma once
/// A step of a diagnosis: fits to some gauges predict the others, for each explanation and for the verdict.
#include <string>
#include <vector>

#include "uq/diagnosis/fit_library.hpp"

namespace calomel {

/// Misfits of held-out records, mean over the records, and where they come from.
struct HoldOutSummary {
  double before = 0, after = 0;              ///< by the base model, and by what is named; the same where nothing is
  std::vector<double> history;               ///< (values of the model): each gauge by the base fit without it
  std::vector<HeldOutCondition> conditions;  ///< where there are several
};

/// Keeps the hold-out predictions of an explanation's fit in the explanation.
void keep_held_out_fit(const HeldOut& held_out, HeldOutFit fit, Alternative& a);

/// Makes the hold-out predictions of an explanation that has a fit of its own and a positive log Bayes factor, once. Of a target, a fault of one gauge has
/// none: one of many gauges hardly moves what the others are predicted by.
void add_hold_out_predictions(const FitContext& context, Alternative& a);

/// The summary for a verdict. Each fold is predicted by the explanation with the greatest evidence without the gauges of that fold. An explanation without a
/// fit of its own, such as a fault of a gauge, predicts no other gauge: nothing changes with it.
[[nodiscard]] HoldOutSummary summarise_hold_out(const FitContext& context, const Verdict& verdict);

}  // namespace calomel
