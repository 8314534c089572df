#pragma once
/// Sums of numbers that are known by their logarithms, however large or small these are. A term without a weight has the weight 1.
#include <span>
#include <vector>

namespace calomel {

/// log sum_i w_i exp(logs_i); logs: (n), n > 0; weights: (n) or none. -infinity where every logarithm is.
[[nodiscard]] double log_sum(std::span<const double> logs, std::span<const double> weights = {});
/// log of the mean of exp(logs_i).
[[nodiscard]] double log_mean(std::span<const double> logs);
/// w_i exp(logs_i) over their sum, (n). Not a number where every logarithm is -infinity.
[[nodiscard]] std::vector<double> shares(std::span<const double> logs, std::span<const double> weights = {});

}  // namespace calomel
