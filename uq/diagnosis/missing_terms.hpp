#pragma once
/// What is missing where no mechanism explains the records: which terms, of which part of the mercury or stretch of a wall, would do what is missing. A
/// description, no name.
#include <string>
#include <vector>

#include "uq/diagnosis/question.hpp"

namespace calomel {

struct MissingTerm {
  std::string what, place;  ///< "mass", "on the top wall, x = 25 to 50 mm"
  std::string unit;
  double value = 0, sd = 0;     ///< to first order, in the unit
  double log_bayes_factor = 0;  ///< over the terms before it, its choice among all that were asked about taken off
};

struct MissingTerms {
  std::vector<MissingTerm> terms;  ///< the one that says most first; empty: none says anything
  std::size_t asked = 0;           ///< terms at places
  /// |history - record| / |record|, mean over the gauges: of the base model, and as a run with these terms changes it; 0 where none was made.
  double misfit_before = 0, misfit_after = 0;
  std::vector<std::string> skipped;  ///< what could not be asked, and why
};

/// Terms are taken one by one, each the one that says most beside those before it, to first order about the fit, while its log Bayes factor over them less the
/// logarithm of how many were asked about is above 5, what a name has to lead by, and its number within what its law allows; three at most. The model is then
/// run with them, where the first order puts them and the parameters. `in.groups`: one number each. Errors: those of `ask`.
[[nodiscard]] MissingTerms missing_terms(const QuestionInputs& in);

/// Runs that this takes.
[[nodiscard]] int missing_terms_runs(const std::vector<ParameterGroup>& groups);

}  // namespace calomel
