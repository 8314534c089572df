#pragma once
/// The diagnosis of omitted physics: fits the base model, asks of every mechanism what it would be worth, fits those that lead in the true model, and judges.
#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "forward/parameter_group.hpp"
#include "inverse/posterior/posterior_fit.hpp"
#include "uq/diagnosis/held_out.hpp"
#include "uq/diagnosis/locate.hpp"
#include "uq/diagnosis/missing_terms.hpp"
#include "uq/diagnosis/mixed_up.hpp"
#include "uq/diagnosis/question.hpp"
#include "uq/diagnosis/verdict.hpp"

namespace calomel {

struct Provenance;  // base/provenance.hpp

/// `[diagnosis]` of a case file.
struct DiagnosisOptions {
  int max_runs = 2000;
  int leaders = 4;
  bool pairs = true;
  int term_runs = 200;

  template <class V>
  void visit(V& v) {
    v("max_runs", max_runs,
      {.range = between(10, 1000000),
       .doc = "ensemble means of the true model after which no further fit is begun; what does not fit in is skipped and told. Of a line or a model outside 10 "
              "000 by default"});
    v("leaders", leaders, {.range = between(1, 20), .doc = "mechanisms that are fitted in the true model at most, those that lead to first order first"});
    v("pairs", pairs, {.doc = "whether two mechanisms together are tried where none alone explains the records, and a gauge at fault beside one that does"});
    v("term_runs", term_runs,
      {.range = between(0, 1000000),
       .doc = "runs of the coarser mesh at most, beyond max_runs, for the terms that describe what is missing where the verdict on a target is unknown; 0 = "
              "none"});
  }
};

struct DiagnosisInputs {
  const PosteriorInputs& base;             ///< of the physical product; its box stands
  std::vector<ParameterGroup> groups;      ///< offered
  std::vector<ParameterGroup> terms = {};  ///< by which what is missing is described where no group explains the records; may be empty
  RunAdded run;
  DiagnosisOptions options;
  std::function<void(const std::string&)> say;                                      ///< what is being done; may be empty
  std::function<void(const PosteriorRound&, const std::vector<Parameter>&)> round;  ///< told after every fit of a candidate's emulator; may be empty
};

struct Estimate {
  std::string name;
  double mean = 0, sd = 0;
  bool told = true;  ///< by the records; otherwise mean and sd are the prior's
};

/// One explanation beside the base model, in all that is known of it.
struct Alternative {
  Explanation explanation;
  std::vector<std::string> groups;            ///< one, or two of a pair
  std::string sensor;                         ///< of a fault of one gauge
  std::vector<std::string> other_sensors;     ///< gauges whose fault explains as much: the records do not tell which it is
  std::map<std::string, std::string> places;  ///< by group: the wall that it acts on and the stretch of it, as fitted, or the law; empty: it has none
  double first_log_bayes_factor = 0;          ///< to first order about the base fit
  double choice = 0;                          ///< Question::choice, that of both of a pair; it is in both log Bayes factors
  double p_value = 1;                         ///< of its score test, not corrected for their number
  std::vector<Estimate> numbers;              ///< natural units
  std::vector<Estimate> base_parameters;      ///< of the case's own, with it
  std::vector<double> history;                ///< (values of the model) at its mode
  std::vector<double> held_out;               ///< misfit of each fold without it and with it, one after another
  std::vector<double> held_out_worth;         ///< log Bayes factor by the gauges that are left, of each fold
  double held_out_gain = 0;                   ///< 1 - after / before
  std::vector<double> held_out_history;       ///< (values of the model): each gauge by the fit without it; empty where none was made
  int runs = 0;                               ///< made for it alone
  bool settled = false;                       ///< more runs would not change it
  std::string message;
};

struct Diagnosis {
  PosteriorFit base;
  BaseEvidence evidence;
  std::vector<std::string> likeliest_place;  ///< gauges, one or two, of the place where something alone would say most; empty: they have no places
  std::vector<Alternative> candidates;       ///< the best first
  Verdict verdict;
  LocatedMismatch location;
  std::vector<MixedUp> mixed_up;          ///< gauges that look wired wrongly; nothing is asked of mechanisms then
  std::vector<std::string> dead;          ///< gauges that record nothing but noise, which are left out
  std::optional<LateRecords> late;        ///< where all records being late says more than any explanation, to first order; told first, too
  std::vector<Estimate> base_parameters;  ///< by the base model
  std::vector<double> handbook_pulls;     ///< of those, in prior standard deviations
  std::vector<double> base_history;       ///< (values of the model)
  double held_out_before = 0, held_out_after = 0;
  std::vector<double> held_out_history;               ///< (values of the model): each gauge by the base fit without it
  std::vector<HeldOutCondition> held_out_conditions;  ///< where there are several
  int runs = 0;
  bool spent = false;                   ///< diagnosis.max_runs left a fit out, or ended it before it had settled
  std::vector<std::string> skipped;     ///< what was not done, and why
  std::optional<MissingTerms> missing;  ///< where the verdict is unknown and terms are offered
  std::string separating;               ///< the measurement that would tell the first two apart

  /// The explanation of this name, or null.
  [[nodiscard]] const Alternative* alternative(const std::string& name) const;
  /// The explanations of all candidates as sort_by_evidence leaves them.
  [[nodiscard]] std::vector<Explanation> by_evidence() const;
  /// The fits on which the verdict hangs and which more runs might still change: of what is named, else "base", the base model's, or of what comes nearest and
  /// for which, or for a second effect beside it, no runs were left. Such a verdict is not to be acted on. A name does not hang on the base fit, which wanders
  /// where physics is left out: that of the name holds the base model, its numbers off, in its box.
  [[nodiscard]] std::vector<std::string> unsettled() const;
};

/// Errors: those of fit_posterior and of the runs; Interrupted.
[[nodiscard]] Diagnosis diagnose(const DiagnosisInputs& in);

/// The contents of diagnosis.json.
[[nodiscard]] Json diagnosis_json(const Diagnosis& d, const DiagnosisInputs& in, const Provenance& provenance);

}  // namespace calomel
