#pragma once
/// A step of a diagnosis: the measurement that would distinguish the two leading explanations.
#include <optional>
#include <string>
#include <vector>

#include "uq/diagnosis/alternative.hpp"
#include "uq/diagnosis/base_fit.hpp"

namespace calomel {

/// The gauge and the time at which the first two explanations differ most, or the first and the base model, in standard deviations of a mean record.
struct SeparatingMeasurement {
  std::string first, second;       ///< explanations; second empty: the base model
  std::string gauge;               ///< Problem::label
  double time = 0;                 ///< [s]
  double difference = 0;           ///< of the two there, in `unit`
  std::string unit;                ///< Problem::mae_unit
  double standard_deviations = 0;  ///< the difference over the standard deviation of the mean record and of what is not known of it
};

/// Compares what the verdict names with the explanation of the greatest evidence beside it. Nothing where no explanation has a history.
[[nodiscard]] std::optional<SeparatingMeasurement> separating_measurement(const Problem& problem, const BaseFit& base,
                                                                          const std::vector<Alternative>& candidates, const Verdict& verdict);

/// The explanations of all candidates as sort_by_evidence leaves them.
[[nodiscard]] std::vector<Explanation> explanations_by_evidence(const BaseEvidence& base, const std::vector<Alternative>& candidates);

/// The candidate of this name, or null.
[[nodiscard]] const Alternative* find_alternative(const std::vector<Alternative>& candidates, const std::string& name);

}  // namespace calomel
