#include "uq/drawn_noise_density.hpp"

#include <algorithm>
#include <cmath>

#include "base/log_sum.hpp"

namespace calomel {

namespace {

const LogPosterior& first_of(std::span<const DrawnNoise> draws) {
  expect(!draws.empty(), "there is at least one draw of the hyperparameters");
  return draws[0].posterior;
}

Eigen::VectorXd vector_of(std::span<const double> x) { return Eigen::Map<const Eigen::VectorXd>(x.data(), Eigen::Index(x.size())); }

}  // namespace

DrawnNoiseDensity::DrawnNoiseDensity(std::span<const DrawnNoise> draws) : draws_(draws), first_(first_of(draws)) {}

// Prior and Jacobian are the same for all draws, so that the mean of the densities is the mean of the likelihoods times them.
double DrawnNoiseDensity::log_density(std::span<const double> x) const {
  const Eigen::VectorXd q = vector_of(x);
  std::vector<double> logs;
  for (const auto& d : draws_) logs.push_back(d.posterior.log_density(q));
  return log_mean(logs);
}

double DrawnNoiseDensity::log_density_and_gradient(std::span<const double> x, std::span<double> gradient) const {
  const Eigen::VectorXd q = vector_of(x);
  std::vector<double> logs;
  Eigen::MatrixXd gradients(q.size(), Eigen::Index(draws_.size()));
  Eigen::VectorXd g;
  for (const auto& d : draws_) {
    logs.push_back(d.posterior.log_density(q, &g));
    gradients.col(Eigen::Index(logs.size()) - 1) = g;
  }
  const double value = log_mean(logs);
  g.setZero(q.size());
  if (std::isfinite(value)) {
    const auto w = shares(logs);
    g = gradients * Eigen::Map<const Eigen::VectorXd>(w.data(), Eigen::Index(w.size()));
  }
  std::copy(g.begin(), g.end(), gradient.begin());
  return value;
}

std::vector<double> DrawnNoiseDensity::weights(const Eigen::VectorXd& q) const {
  std::vector<double> logs;
  for (const auto& d : draws_) logs.push_back(d.posterior.log_density(q));
  return shares(logs);
}

NoiseInflation noise_inflation(const DrawnNoiseDensity& density, const LogPosterior& estimate, const Draws& coordinates, const Draws& quantities,
                               std::size_t most) {
  const std::size_t all = coordinates.chains * coordinates.draws;
  const std::size_t d = coordinates.names.size();
  const std::size_t n = quantities.names.size();
  const std::size_t step = std::max<std::size_t>(1, all / std::max<std::size_t>(1, most));
  NoiseInflation out;
  std::vector<double> logs;                     // log density under the estimate less that of the mean, by draw
  std::vector<std::vector<double>> draw_share;  // share of each draw of the hyperparameters, by draw
  std::vector<std::size_t> taken;
  for (std::size_t i = 0; i < all; i += step) {
    const std::span<const double> x = std::span(coordinates.values).subspan(i * d, d);
    draw_share.push_back(density.weights(vector_of(x)));
    logs.push_back(estimate.log_density(vector_of(x)) - density.log_density(x));
    taken.push_back(i);
  }
  // p_b / p is the share of b times the number of hyperparameter draws. Over the draws, the weights of b are that share divided by its sum.
  out.weights.assign(draw_share[0].size(), 0.0);
  for (const auto& w : draw_share)
    for (std::size_t b = 0; b < w.size(); ++b) out.weights[b] += w[b] / double(taken.size());
  for (const double w : out.weights) out.effective_draws += w * w;
  out.effective_draws = 1 / out.effective_draws;
  const std::vector<double> by_estimate = shares(logs);
  const std::vector<double> evenly(taken.size(), 1 / double(taken.size()));
  std::vector<double> alike(taken.size(), 0.0);
  double squares = 0;
  // A draw of the hyperparameters with weight 0 at all draws of the chains has no standard deviation and is not counted.
  const auto counted = double(std::count_if(out.weights.begin(), out.weights.end(), [](double w) { return w > 0; }));
  for (std::size_t i = 0; i < taken.size(); ++i) {
    for (std::size_t b = 0; b < out.weights.size(); ++b)
      if (out.weights[b] > 0) alike[i] += draw_share[i][b] / (out.weights[b] * double(taken.size()) * counted);
    squares += by_estimate[i] * by_estimate[i];
  }
  out.plug_in_draws = 1 / squares;
  for (std::size_t k = 0; k < n; ++k) {
    const auto moments = [&](const std::vector<double>& weights) {
      double mean = 0;
      double variance = 0;
      for (std::size_t i = 0; i < taken.size(); ++i) mean += weights[i] * quantities.values[taken[i] * n + k];
      for (std::size_t i = 0; i < taken.size(); ++i) variance += weights[i] * std::pow(quantities.values[taken[i] * n + k] - mean, 2);
      return std::pair(mean, std::sqrt(variance));
    };
    const auto [mean, sd] = moments(evenly);
    const auto [plug_in_mean, plug_in_sd] = moments(by_estimate);
    out.sd_ratio.push_back(sd / plug_in_sd);
    out.sd_ratio_alike.push_back(moments(alike).second / plug_in_sd);
    out.shift.push_back((mean - plug_in_mean) / plug_in_sd);
  }
  return out;
}

}  // namespace calomel
