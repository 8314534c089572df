#include "base/log_sum.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/errors.hpp"

namespace calomel {

namespace {

/// w_i exp(logs_i - most).
std::vector<double> scaled(std::span<const double> logs, std::span<const double> weights, double most) {
  std::vector<double> out(logs.size());
  for (std::size_t i = 0; i < logs.size(); ++i) out[i] = (weights.empty() ? 1 : weights[i]) * std::exp(logs[i] - most);
  return out;
}

double most_of(std::span<const double> logs, std::span<const double> weights) {
  expect(!logs.empty() && (weights.empty() || weights.size() == logs.size()), "there is a sum, and a weight for every term");
  return *std::max_element(logs.begin(), logs.end());
}

double sum_of(const std::vector<double>& x) { return std::accumulate(x.begin(), x.end(), 0.0); }

}  // namespace

double log_sum(std::span<const double> logs, std::span<const double> weights) {
  const double most = most_of(logs, weights);
  return std::isinf(most) ? most : most + std::log(sum_of(scaled(logs, weights, most)));
}

double log_mean(std::span<const double> logs) {
  const double most = most_of(logs, {});
  return std::isinf(most) ? most : most + std::log(sum_of(scaled(logs, {}, most)) / double(logs.size()));
}

std::vector<double> shares(std::span<const double> logs, std::span<const double> weights) {
  auto out = scaled(logs, weights, most_of(logs, weights));
  const double sum = sum_of(out);
  for (double& x : out) x /= sum;
  return out;
}

}  // namespace calomel
