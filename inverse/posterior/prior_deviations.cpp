#include "inverse/posterior/prior_deviations.hpp"

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.hpp"

namespace calomel {

std::vector<PriorDeviation> prior_deviations(const FitResidual& left) {
  const Cholesky covariance(left.covariance);
  const Eigen::VectorXd residual = covariance.solve_lower(left.residual);
  std::vector<PriorDeviation> all;
  for (const auto& d : left.directions) {
    const Eigen::VectorXd change = covariance.solve_lower(d.change);
    all.push_back({.term = d.term, .gauge = d.gauge, .deviation = change.dot(residual), .sd = std::sqrt(std::max(0.0, 1 - change.squaredNorm()))});
  }
  std::stable_sort(all.begin(), all.end(), [](const PriorDeviation& a, const PriorDeviation& b) { return std::abs(a.deviation) > std::abs(b.deviation); });
  return all;
}

}  // namespace calomel
