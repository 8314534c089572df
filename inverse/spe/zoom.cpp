#include "inverse/spe/zoom.hpp"

#include <algorithm>
#include <cmath>

#include "forward/campaign/campaign.hpp"

namespace calomel {

namespace {

constexpr std::size_t best_runs = 6;
constexpr double margin = 0.1, least_share = 0.5, largest_share = 0.75, edge = 0.1;

/// Whether `x` lies at an end of [low, high] that is not one of the bounds.
bool at_end(double x, double low, double high, double bound_low, double bound_high) {
  const double near = edge * (high - low);
  return (x < low + near && low > bound_low) || (x > high - near && high < bound_high);
}

}  // namespace

bool at_edge(const Bounds& bounds, const Bounds& now, const std::vector<double>& best) {
  for (Eigen::Index k = 0; k < now.low.size(); ++k)
    if (at_end(best[std::size_t(k)], now.low[k], now.high[k], bounds.low[k], bounds.high[k])) return true;
  return false;
}

Bounds next_box(const Bounds& bounds, const Bounds& now, std::span<const Proposal> ranked, const Eigen::MatrixXd& optima, bool smaller) {
  expect(!ranked.empty(), "a box is drawn about runs");
  Bounds box = now;
  for (Eigen::Index k = 0; k < now.low.size(); ++k) {
    const double best = ranked[0].theta[std::size_t(k)];
    double reach = 0;
    for (const auto& p : ranked.first(std::min(best_runs, ranked.size()))) reach = std::max(reach, std::abs(p.theta[std::size_t(k)] - best));
    if (optima.cols() > 0) {
      std::vector<double> row(optima.row(k).begin(), optima.row(k).end());
      std::sort(row.begin(), row.end());
      reach = std::max({reach, best - row[row.size() / 4], row[(3 * row.size()) / 4] - best});
    }
    double side = now.high[k] - now.low[k];
    if (smaller && !at_end(best, now.low[k], now.high[k], bounds.low[k], bounds.high[k]))
      side = std::clamp(2 * (1 + 2 * margin) * reach, least_share * side, largest_share * side);
    box.low[k] = std::clamp(best - side / 2, bounds.low[k], bounds.high[k] - side);
    box.high[k] = box.low[k] + side;
  }
  return box;
}

Eigen::MatrixXd points_in(const Bounds& box, const std::vector<Parameter>& parameters, std::size_t runs, std::uint64_t seed) {
  std::vector<Parameter> inside = parameters;
  for (std::size_t k = 0; k < inside.size(); ++k) inside[k].min = box.low[Eigen::Index(k)], inside[k].max = box.high[Eigen::Index(k)];
  return design_points("chebyshev", inside, runs, seed);
}

}  // namespace calomel
