#include "inverse/spe/zoom.hpp"

#include <algorithm>

#include "forward/campaign/campaign.hpp"

namespace calomel {

namespace {

constexpr double edge = 0.1;  ///< of a side

/// Whether `x` lies at an end of [low, high] that is not one of the bounds.
bool at_end(double x, double low, double high, double bound_low, double bound_high) {
  const double near = edge * (high - low);
  const double slack = 1e-9 * (high - low);  // a sum of a low end and a side may miss the bound by its rounding
  return (x < low + near && low > bound_low + slack) || (x > high - near && high < bound_high - slack);
}

}  // namespace

bool at_edge(const Bounds& bounds, const Bounds& now, const std::vector<double>& best) {
  for (Eigen::Index k = 0; k < now.low.size(); ++k)
    if (at_end(best[std::size_t(k)], now.low[k], now.high[k], bounds.low[k], bounds.high[k])) return true;
  return false;
}

Bounds next_box(const Bounds& bounds, const Bounds& now, const std::vector<double>& best, bool smaller) {
  Bounds box = now;
  for (Eigen::Index k = 0; k < now.low.size(); ++k) {
    const double x = best[std::size_t(k)];
    const bool moves = !smaller || at_end(x, now.low[k], now.high[k], bounds.low[k], bounds.high[k]);
    const double side = (moves ? 1.0 : 0.5) * (now.high[k] - now.low[k]);
    box.low[k] = std::clamp(x - side / 2, bounds.low[k], bounds.high[k] - side);
    box.high[k] = std::min(box.low[k] + side, bounds.high[k]);
  }
  return box;
}

Eigen::MatrixXd points_in(const Bounds& box, const std::vector<Parameter>& parameters, std::size_t runs, std::uint64_t seed) {
  std::vector<Parameter> inside = parameters;
  for (std::size_t k = 0; k < inside.size(); ++k) inside[k].min = box.low[Eigen::Index(k)], inside[k].max = box.high[Eigen::Index(k)];
  return design_points("chebyshev", inside, runs, seed);
}

}  // namespace calomel
