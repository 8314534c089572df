#pragma once
/// A diagnosis in plain English, for a reader who has never heard of evidence. Every sentence about one is made here: diagnosis.json holds them, the terminal
/// and the report show them.
#include <span>
#include <string>
#include <vector>

#include "uq/diagnosis/plain_numbers.hpp"

namespace calomel {

/// Misfits as of misfit_of_all [-], in the band of frequencies that the diagnosis compares.
struct Misfits {
  double before = 0, after = 0;                    ///< of the base model, and with what is named
  double held_out_before = 0, held_out_after = 0;  ///< the same of what was left out of the fit
  std::string held_out = "gauges";                 ///< what that was: "stretches of the record" of a single one
};

/// Where and when the first two explanations differ most, or the first and the base model, in standard deviations of a mean record: what to measure to tell
/// them apart.
[[nodiscard]] std::string separating_measurement(const Diagnosis& d, const Problem& problem);

/// Why the entry of the ranking is what the verdict says or not, and what would have to be otherwise.
struct Why {
  std::string why, would_change;
};
[[nodiscard]] Why why(const Diagnosis& d, const std::string& name, std::span<const ParameterGroup> groups, const Gates& gates = {});

/// "+12 ± 2 kg/m^2" of a term, as a change; a share in percent.
[[nodiscard]] std::string plain_term(const MissingTerm& term);
/// What is missing, in one sentence or two; says so where no term says anything.
[[nodiscard]] std::string plain_missing(const MissingTerms& missing);

/// "Gauge T2 reads what is simulated there with the other sign (correlation -0.98): see whether it is wired the wrong way round, or its direction wrong."
[[nodiscard]] std::string plain_mixed_up(const MixedUp& m);
/// "All records look 3.07 ± 0.12 µs late (log Bayes factor 75.6 to first order): see from which instant they count, ..."
[[nodiscard]] std::string plain_late(const LateRecords& l);

/// A verdict in two sentences; where there are slips, these in place of the second.
struct PlainSummary {
  std::string finding, next_step;
  [[nodiscard]] std::string text() const { return finding + ' ' + next_step; }
};
[[nodiscard]] PlainSummary plain_summary(const Diagnosis& d, std::span<const ParameterGroup> groups, const Misfits& misfits, const Gates& gates = {});

}  // namespace calomel
