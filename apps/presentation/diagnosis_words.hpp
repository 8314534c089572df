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

/// The measurement that would distinguish the first two explanations.
[[nodiscard]] std::string separating_text(const std::optional<SeparatingMeasurement>& measurement);

/// The effect and the place of what is missing, or that no term has enough evidence.
[[nodiscard]] std::string missing_sentence(const MissingTerms& missing);

}  // namespace calomel
