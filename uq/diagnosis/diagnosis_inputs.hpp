#pragma once
/// Options and inputs of a diagnosis.
#include <functional>
#include <vector>

#include "base/options.hpp"
#include "forward/parameter_group.hpp"
#include "inverse/posterior/posterior_fit.hpp"
#include "uq/diagnosis/events.hpp"
#include "uq/diagnosis/screening.hpp"

namespace calomel {

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
       .doc = "runs (ensemble means of the true model) after which no further fit begins; diagnosis.json lists the skipped steps. The default for a line or "
              "an external model is 10 000"});
    v("leaders", leaders,
      {.range = between(1, 20), .doc = "mechanisms that are fitted in the true model, at most; those with the greatest evidence to first order come first"});
    v("pairs", pairs, {.doc = "whether two mechanisms together are fitted if none alone explains the records, and a faulty gauge beside one that does"});
    v("term_runs", term_runs,
      {.range = between(0, 1000000),
       .doc = "runs of the coarser mesh, at most, beyond max_runs, for the terms that describe the missing effect if the verdict on a target is unknown; 0 = "
              "no such terms"});
  }
};

struct DiagnosisInputs {
  const PosteriorInputs& base;             ///< of the physical product, with its first box
  std::vector<ParameterGroup> groups;      ///< candidates
  std::vector<ParameterGroup> terms = {};  ///< that describe what is missing where no group explains the records; may be empty
  RunAdded run;
  DiagnosisOptions options;
  std::function<void(const DiagnosisEvent&)> report;                                ///< what is being done; may be empty
  std::function<void(const PosteriorRound&, const std::vector<Parameter>&)> round;  ///< called after every fit of a candidate's emulator; may be empty

  /// Number of the case's own parameters; the fit has nuisances behind them.
  [[nodiscard]] std::size_t own_parameters() const { return base.problem.shape.parameters.size(); }
  /// Mesh of the runs about a fit: the next coarser one.
  [[nodiscard]] int coarser_level() const { return base.levels > 1 ? 1 : 0; }
  void say(const DiagnosisEvent& event) const {
    if (report) report(event);
  }
};

}  // namespace calomel
