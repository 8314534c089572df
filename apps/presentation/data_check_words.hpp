#pragma once
/// The sentences about data checks: mistakes of the case or of the wiring that a fit shows.
#include <string>
#include <vector>

#include "uq/data_checks.hpp"

namespace calomel {

/// "The record of gauge T2 has the opposite sign of its simulation (correlation -0.98). Check its wiring and its direction in the case."
[[nodiscard]] std::string mislabelled_sentence(const MislabelledChannel& channel);
/// "All records look 3.07 ± 0.12 µs late (log Bayes factor 75.6 to first order). Check the instant from which they count, ..."
[[nodiscard]] std::string clock_sentence(const ClockOffset& offset);

/// One sentence for each finding, the gravest first: dead gauges, mixed-up channels, the clock, numbers far from their priors.
[[nodiscard]] std::vector<std::string> data_check_sentences(const DataChecks& checks, const ErrorOptions& options);

}  // namespace calomel
