#pragma once
/// The diagnosis of omitted physics: fits the base model, screens every mechanism, fits the leading ones in the true model, and judges.
#include <optional>
#include <string>
#include <vector>

#include "uq/diagnosis/alternative.hpp"
#include "uq/diagnosis/base_fit.hpp"
#include "uq/diagnosis/clock_offset.hpp"
#include "uq/diagnosis/diagnosis_inputs.hpp"
#include "uq/diagnosis/hold_out_predictions.hpp"
#include "uq/diagnosis/locate.hpp"
#include "uq/diagnosis/missing_terms.hpp"
#include "uq/diagnosis/run_budget.hpp"
#include "uq/diagnosis/separating_measurement.hpp"
#include "uq/diagnosis/verdict.hpp"

namespace calomel {

/// Misfits of misfit_of_all [-] in the band of frequencies that the diagnosis compares, mean over the gauges.
struct VerdictMisfits {
  double before = 0, after = 0;                    ///< of the base model, and with what is named
  double held_out_before = 0, held_out_after = 0;  ///< the same of what was held out of the fit
  bool single_record = false;                      ///< stretches of one record were held out, else gauges
};

struct Diagnosis {
  BaseFit base;
  std::vector<Alternative> candidates;  ///< greatest log Bayes factor first
  Verdict verdict;
  LocatedMismatch location;
  std::vector<std::string> dead;     ///< gauges that record nothing but noise, which are left out
  std::optional<ClockOffset> clock;  ///< where an offset of the clock has more evidence than any explanation, to first order
  HoldOutSummary hold_out;
  VerdictMisfits misfits;
  int runs = 0;
  bool budget_exhausted = false;        ///< diagnosis.max_runs left a fit out, or ended it before it had settled
  std::vector<SkippedStep> skipped;     ///< what was not done, in the order in which it was left out
  std::optional<MissingTerms> missing;  ///< where the verdict is unknown and terms are offered
  std::optional<SeparatingMeasurement> separating;

  /// The explanation of this name, or null.
  [[nodiscard]] const Alternative* alternative(const std::string& name) const { return find_alternative(candidates, name); }
  /// The first explanation that the verdict names, or null.
  [[nodiscard]] const Alternative* named() const { return verdict.mechanisms.empty() ? nullptr : alternative(verdict.mechanisms[0]); }
  /// The explanations of all candidates as sort_by_evidence leaves them.
  [[nodiscard]] std::vector<Explanation> by_evidence() const { return explanations_by_evidence(base.evidence, candidates); }
  /// The fits that decide the verdict and that more runs might still change; such a verdict is not to be acted on. They are those of what is named. Where
  /// nothing is named, "base" is the base model's, or the explanation that comes nearest has no fit, or no runs were left for a second effect beside it. A name
  /// does not depend on the base fit, which wanders where physics is left out: the fit of the name contains the base model, with its numbers off.
  [[nodiscard]] std::vector<std::string> unsettled() const;
};

/// Makes a diagnosis. Its steps, each in its own header: base_fit, screening, leading_fits (with linearised_fit and explanation_fit), judgement, pair_fits,
/// hold_out_predictions, locate, missing_terms, separating_measurement. Errors: those of fit_posterior and of the runs; Interrupted.
[[nodiscard]] Diagnosis diagnose(const DiagnosisInputs& in);

}  // namespace calomel
