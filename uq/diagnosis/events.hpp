#pragma once
/// Events that a diagnosis reports while it runs. The presentation makes lines of them.
#include <string>
#include <variant>

#include "uq/diagnosis/clock_offset.hpp"
#include "uq/diagnosis/mislabelled_channels.hpp"

namespace calomel {

struct BaseFitBegins {};

/// Log evidence of a discrepancy in one place alone, over that of the base model's whole mixture.
struct LocalEvidenceFound {
  double log_evidence = 0;
};

struct ScreeningBegins {
  std::string on_top_of = {};  ///< the explanation that candidates are added to; empty: the base model
  bool gauges_alone = false;   ///< whether faults of gauges alone are screened
};

/// A candidate whose log Bayes factor to first order is great enough for a fit.
struct CandidateScreened {
  std::string label;
  double log_bayes_factor = 0, p_value = 1;
  bool on_top = false;  ///< of an explanation
};

struct FitBegins {
  std::string name;
  int runs = 0;  ///< of the diagnosis so far
};

struct ExplanationFitted {
  std::string name;
  double log_bayes_factor = 0, chi2 = 0;
  double values = 0, base_chi2 = 0;  ///< the base model's
  int runs = 0;                      ///< made for it
};

/// The terms that describe what is missing are screened.
struct TermScreeningBegins {};

using DiagnosisEvent = std::variant<BaseFitBegins, LocalEvidenceFound, MislabelledChannel, ScreeningBegins, CandidateScreened, ClockOffset, FitBegins,
                                    ExplanationFitted, TermScreeningBegins>;

}  // namespace calomel
