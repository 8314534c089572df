#pragma once
/// The sentences about data checks: what a fit shows of mistakes of the case or of the wiring.
#include <string>
#include <vector>

#include "uq/data_checks.hpp"

namespace calomel {

/// "Gauge T2 reads what is simulated there with the other sign (correlation -0.98): see whether it is wired the wrong way round, or its direction wrong."
[[nodiscard]] std::string mislabelled_sentence(const MislabelledChannel& channel);
/// "All records look 3.07 ± 0.12 µs late (log Bayes factor 75.6 to first order): see from which instant they count, ..."
[[nodiscard]] std::string clock_sentence(const ClockOffset& offset);

/// One sentence for each finding, the gravest first: dead gauges, mixed-up channels, the clock, numbers far from their priors.
[[nodiscard]] std::vector<std::string> data_check_sentences(const DataChecks& checks, const ErrorOptions& options);

}  // namespace calomel
