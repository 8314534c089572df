#pragma once
/// State that the fits of a diagnosis share: the explanations and fits made so far, and the inputs of every fit.
#include <map>
#include <string>
#include <vector>

#include "uq/diagnosis/alternative.hpp"
#include "uq/diagnosis/base_fit.hpp"
#include "uq/diagnosis/held_out.hpp"
#include "uq/diagnosis/run_budget.hpp"

namespace calomel {

/// An explanation as it was fitted, to which a further one is added.
struct ExplanationFit {
  std::vector<AddedParameter> added;  ///< in the order of the fit's parameters, behind the base model's
  PosteriorInputs inputs;             ///< without the run function
  PosteriorFit fit;
};

/// Explanations found so far, and their fits.
struct FitLibrary {
  std::vector<Alternative> candidates;         ///< in the order in which they were made, until they are judged
  std::map<std::string, ExplanationFit> fits;  ///< by the explanation's name

  /// Greatest log Bayes factor of those that were fitted; 0 where none was.
  [[nodiscard]] double best_log_bayes_factor() const;
};

constexpr double least_to_fit = 3;               ///< log Bayes factor of a candidate that is fitted
constexpr double far_behind = 2 * Gates{}.lead;  ///< log Bayes factors behind the best: twice the lead that a name needs, as first order is not exact

/// Whether an explanation of this log Bayes factor could lead the best one.
[[nodiscard]] inline bool may_lead(double log_bayes_factor, double best) { return log_bayes_factor > least_to_fit && log_bayes_factor > best - far_behind; }

/// Inputs of every fit of an explanation. All that is referred to outlives it.
struct FitContext {
  const DiagnosisInputs& in;
  const BaseFit& base;
  const HeldOut& held_out;
  RunBudget& budget;
  FitLibrary& library;

  /// The fit that an explanation is added to: that of `on_top_of`, or the base model's.
  [[nodiscard]] const PosteriorFit& fit_below(const Alternative* on_top_of) const {
    return on_top_of ? library.fits.at(on_top_of->explanation.name).fit : base.fit;
  }
};

/// Screening about a fit to which these numbers were added, on the coarser mesh. The arguments outlive the result.
[[nodiscard]] ScreeningInputs screening_about(const DiagnosisInputs& in, RunBudget& budget, const PosteriorFit& fit, std::vector<AddedParameter> added,
                                              const std::vector<ParameterGroup>& groups);

/// A number of an explanation as it is reported, in the unit of the case. A share is multiplied by the number that it is a share of, which is one of the case's
/// parameters (`own`) or is in the case. A share that the records do not narrow to half its prior's deviation is reported as its prior.
[[nodiscard]] Estimate reported_number(const DiagnosisInputs& in, const AddedParameter& a, double mean, double sd, const std::vector<Estimate>& own);

/// Reports an explanation that was fitted.
void report_fitted(const FitContext& context, const Alternative& a);

}  // namespace calomel
