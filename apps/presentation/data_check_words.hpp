#pragma once
/// The sentences about data checks: mistakes of the case or of the wiring that a fit shows.
#include <span>
#include <string>
#include <vector>

#include "uq/data_checks.hpp"

namespace calomel {

/// "The record of gauge T2 has the opposite sign of its simulation (correlation -0.98). Check its wiring and its direction in the case."
[[nodiscard]] std::string mislabelled_sentence(const MislabelledChannel& channel);
/// "All records look 3.07 ± 0.12 µs late (log Bayes factor 75.6 to first order). Check the instant from which they count, ..."
[[nodiscard]] std::string clock_sentence(const ClockOffset& offset);

/// "Gauges T2, T3 record nothing but noise and are left out: ..." labels: one at least.
[[nodiscard]] std::string dead_gauges_sentence(std::span<const std::string> labels);
/// The warnings of a problem, then those about its dead gauges and about bands that are too narrow to count.
[[nodiscard]] std::vector<std::string> problem_warnings(const Problem& problem);

/// "the gain of T2", for a marginalised nuisance parameter and its gauge; without a gauge "the energy of all pulses".
[[nodiscard]] std::string nuisance_name(const std::string& term, const std::string& gauge);
/// One sentence for each of the at most three largest deviations beyond far_deviation: "the records shift the gain of T2 by +12.9 of its prior standard
/// deviations (errors.gain_sd), +13 %: ...". The last one counts the others.
[[nodiscard]] std::vector<std::string> far_deviation_sentences(const std::vector<PriorDeviation>& deviations, const ErrorOptions& errors);

/// One sentence for each finding, the gravest first: dead gauges, mixed-up channels, the clock, numbers far from their priors.
[[nodiscard]] std::vector<std::string> data_check_sentences(const DataChecks& checks, const ErrorOptions& options);

}  // namespace calomel
