#include "inverse/map_discrepancy.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace calomel {

namespace {

/// Scales of the discrepancy that are tried, over the local amplitude.
constexpr std::array<double, 8> discrepancy_scales{0, 0.005, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32};

Eigen::MatrixXd shape_of(const Likelihood& plain, const Problem& problem, const MapModels& models, const DiscrepancyOptions& options) {
  return discrepancy_shape(problem, plain.grid(), plain.data(), models.positions, options.distance, matern32(options.time));
}

}  // namespace

Likelihood with_discrepancy(const Likelihood& plain, const Problem& problem, const MapModels& models, const DiscrepancyOptions& options, double scale) {
  return plain.with("discrepancy", scale * scale * shape_of(plain, problem, models, options));
}

Likelihood choose_discrepancy(MapSummary& out, MapSearch& search, const Problem& problem, const Likelihood& plain, const MapModels& models,
                              const MapOptions& options, std::vector<Optimum>& optima) {
  const Eigen::MatrixXd shape = shape_of(plain, problem, models, options.discrepancy);
  std::vector<Optimum> at_scale;
  std::vector<double> log_weight;
  std::vector<double> scales;
  Eigen::VectorXd x = optima[0].x;
  Eigen::VectorXd widths = 0.3 * optima[0].covariance.diagonal().cwiseSqrt();
  for (std::size_t i = discrepancy_scales.size(); i-- > 0;) {
    const double s = discrepancy_scales[i];
    const Likelihood l = plain.with("discrepancy", s * s * shape);
    const auto found = search.optima(l, {x}, {widths}, {});
    if (found.empty()) continue;
    // Weights of the trapezium rule over the scales.
    const double low = i > 0 ? discrepancy_scales[i - 1] : s, high = i + 1 < discrepancy_scales.size() ? discrepancy_scales[i + 1] : s;
    scales.push_back(s), at_scale.push_back(found[0]);
    log_weight.push_back(search.log_evidence(found[0]) - 0.5 * std::pow(s / options.discrepancy.scale, 2) + std::log(0.5 * (high - low)));
    x = found[0].x;
  }
  expect(!scales.empty(), "the mode that was found is found again");
  const auto best = std::size_t(std::max_element(log_weight.begin(), log_weight.end()) - log_weight.begin());
  double total = 0;
  for (const double w : log_weight) total += std::exp(w - log_weight[best]);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(x.size());
  Eigen::MatrixXd second = Eigen::MatrixXd::Zero(x.size(), x.size());
  for (std::size_t i = 0; i < scales.size(); ++i) {
    const double w = std::exp(log_weight[i] - log_weight[best]) / total;
    out.discrepancy_weights.emplace_back(scales[i], w);
    mean += w * at_scale[i].x, second += w * (at_scale[i].covariance + at_scale[i].x * at_scale[i].x.transpose());
  }
  out.discrepancy_scale = scales[best];
  optima[0] = at_scale[best];
  out.scale_spread = (second - mean * mean.transpose() - at_scale[best].covariance).trace() / at_scale[best].covariance.trace();
  return plain.with("discrepancy", out.discrepancy_scale * out.discrepancy_scale * shape);
}

}  // namespace calomel
