#pragma once
/// The reason of a verdict, and of every entry of its ranking.
#include <span>
#include <string>
#include <vector>

#include "uq/diagnosis/diagnosis.hpp"

namespace calomel {

/// The reason of the verdict, in a clause for the terminal.
[[nodiscard]] std::string verdict_reason_text(const Diagnosis& d, const Gates& gates = {});
[[nodiscard]] std::string verdict_reason_text(const BaseEvidence& base, const std::vector<Explanation>& all, const Verdict& verdict, const Gates& gates = {});

/// Why an entry of the ranking is what the verdict names or not, and what would change that.
struct Why {
  std::string why, would_change;
};
[[nodiscard]] Why why(const Diagnosis& d, const std::string& name, std::span<const ParameterGroup> groups, const Gates& gates = {});

}  // namespace calomel
