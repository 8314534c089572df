#pragma once
/// The course of a diagnosis: lines about its events, the ends of its fits, and the steps that were not done.
#include <string>
#include <vector>

#include "uq/diagnosis/diagnosis.hpp"

namespace calomel {

/// The line of the terminal for an event of a running diagnosis.
[[nodiscard]] std::string event_text(const DiagnosisEvent& event);

/// How the fit of an explanation ended; empty where there is nothing to report.
[[nodiscard]] std::string fit_status_text(const Alternative& a);

/// One entry for each group without a candidate.
[[nodiscard]] std::vector<std::string> not_screened_texts(const std::vector<NotScreened>& groups);

/// One entry for each step that was not done.
[[nodiscard]] std::vector<std::string> skipped_texts(const Diagnosis& d);

}  // namespace calomel
