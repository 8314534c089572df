#include "inverse/spe/zoom.hpp"

#include <algorithm>

#include "forward/campaign/campaign.hpp"

namespace calomel {

namespace {

constexpr std::size_t best_runs = 6;
constexpr double margin = 0.1, least_share = 0.5, largest_share = 0.75;

}  // namespace

Bounds shrunken(const Bounds& bounds, const Bounds& now, std::span<const Proposal> ranked, const Eigen::MatrixXd& optima) {
  expect(!ranked.empty(), "a box is drawn about runs");
  Bounds box = now;
  for (Eigen::Index k = 0; k < now.low.size(); ++k) {
    const double best = ranked[0].theta[std::size_t(k)];
    double low = best, high = best;
    for (const auto& p : ranked.first(std::min(best_runs, ranked.size()))) low = std::min(low, p.theta[std::size_t(k)]), high = std::max(high, p.theta[std::size_t(k)]);
    if (optima.cols() > 0) {
      std::vector<double> row;
      for (Eigen::Index i = 0; i < optima.cols(); ++i) row.push_back(optima(k, i));
      std::sort(row.begin(), row.end());
      low = std::min(low, row[row.size() / 4]), high = std::max(high, row[(3 * row.size()) / 4]);
    }
    const double former = now.high[k] - now.low[k];
    const double side = std::clamp((1 + 2 * margin) * (high - low), least_share * former, largest_share * former);
    const double least = std::max(bounds.low[k], best - side), most = std::min(bounds.high[k] - side, best);
    box.low[k] = std::clamp((low + high - side) / 2, std::min(least, most), most);
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
