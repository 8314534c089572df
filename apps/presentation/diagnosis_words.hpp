#pragma once
/// The sentences about a diagnosis, in plain English, for a reader who has never heard of evidence. diagnosis.json holds them; the terminal and the report show
/// them.
#include <span>
#include <string>
#include <vector>

#include "apps/presentation/diagnosis_numbers.hpp"
#include "uq/diagnosis/diagnosis.hpp"
#include "uq/diagnosis/diagnosis_artefacts.hpp"

namespace calomel {

/// All words of diagnosis.json.
[[nodiscard]] DiagnosisText diagnosis_text(const Diagnosis& d, std::span<const ParameterGroup> groups);

/// A verdict in two sentences. Where channels are mixed up or the clock is off, these take the place of the second.
struct PlainSummary {
  std::string finding, next_step;
  [[nodiscard]] std::string text() const { return finding + ' ' + next_step; }
};
[[nodiscard]] PlainSummary plain_summary(const Diagnosis& d, std::span<const ParameterGroup> groups, const Gates& gates = {});

/// What decided the verdict, in a clause for the terminal.
[[nodiscard]] std::string verdict_reason_text(const Diagnosis& d, const Gates& gates = {});
[[nodiscard]] std::string verdict_reason_text(const BaseEvidence& base, const std::vector<Explanation>& all, const Verdict& verdict, const Gates& gates = {});

/// Why an entry of the ranking is what the verdict names or not, and what would change that.
struct Why {
  std::string why, would_change;
};
[[nodiscard]] Why why(const Diagnosis& d, const std::string& name, std::span<const ParameterGroup> groups, const Gates& gates = {});

/// What to measure to distinguish the first two explanations.
[[nodiscard]] std::string separating_text(const std::optional<SeparatingMeasurement>& measurement);

/// What is missing, in one sentence or two; says so where no term has enough evidence.
[[nodiscard]] std::string missing_sentence(const MissingTerms& missing);

/// How the fit of an explanation ended; empty where there is nothing to report.
[[nodiscard]] std::string fit_status_text(const Alternative& a);

/// Groups for which there is no candidate, one entry each.
[[nodiscard]] std::vector<std::string> not_screened_texts(const std::vector<NotScreened>& groups);

/// What was not done, one entry each.
[[nodiscard]] std::vector<std::string> skipped_texts(const Diagnosis& d);

/// The line of the terminal for an event of a running diagnosis.
[[nodiscard]] std::string event_text(const DiagnosisEvent& event);

}  // namespace calomel
