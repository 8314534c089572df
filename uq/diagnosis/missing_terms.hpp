#pragma once
/// A step of a diagnosis where no mechanism explains the records: the terms, each of a part of the mercury or of a stretch of a wall, that would reproduce what
/// is missing. They are a description and no name.
#include <optional>
#include <string>
#include <vector>

#include "uq/diagnosis/screening.hpp"

namespace calomel {

struct MissingTerm {
  std::string what, place;  ///< "mass", "on the top wall, x = 25 to 50 mm"
  std::string unit;
  double value = 0, sd = 0;     ///< to first order, in the unit
  double log_bayes_factor = 0;  ///< over the terms before it, less its selection penalty among all that were screened
};

struct MissingTerms {
  std::vector<MissingTerm> terms;  ///< greatest log Bayes factor first; empty: no term has enough evidence
  std::size_t screened = 0;        ///< terms at places
  /// |history - record| / |record|, mean over the gauges: of the base model, and as a run with these terms changes it; 0 where there is no such run.
  double misfit_before = 0, misfit_after = 0;
  std::size_t offered = 0;                 ///< groups
  std::vector<NotScreened> not_screened;   ///< of these
  std::optional<std::string> run_failure;  ///< message of the run with these terms
};

/// Takes terms one by one, three at most. Each is the term with the greatest log Bayes factor beside those before it, to first order about the fit, less the
/// logarithm of the number of terms. It is taken while that is above 5, the lead that a name needs, and its number is within what its law allows. The model is
/// then run with these terms, at the numbers and parameters of the first order. `in.groups`: one number each. Errors: those of screen_candidates.
[[nodiscard]] MissingTerms missing_terms(const ScreeningInputs& in);

/// Number of runs that this takes.
[[nodiscard]] int missing_terms_runs(const std::vector<ParameterGroup>& groups);

}  // namespace calomel
