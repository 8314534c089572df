#include "inverse/posterior/pulls.hpp"

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.hpp"

namespace calomel {

std::vector<Pull> pulls(const FitResidual& left) {
  const Cholesky covariance(left.covariance);
  const Eigen::VectorXd residual = covariance.solve_lower(left.residual);
  std::vector<Pull> all;
  for (const auto& d : left.directions) {
    const Eigen::VectorXd change = covariance.solve_lower(d.change);
    all.push_back({.term = d.term, .gauge = d.gauge, .pull = change.dot(residual), .sd = std::sqrt(std::max(0.0, 1 - change.squaredNorm()))});
  }
  std::stable_sort(all.begin(), all.end(), [](const Pull& a, const Pull& b) { return std::abs(a.pull) > std::abs(b.pull); });
  return all;
}

}  // namespace calomel
