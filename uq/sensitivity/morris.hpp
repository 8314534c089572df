#pragma once
/// Elementary effects (Morris 1991, Technometrics 33, 161): a first look at which parameters matter and which are linear, by few runs.
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "base/not_finite.hpp"

namespace calomel {

/// Of one quantity and parameter, over its range: mean, mean of absolute values (Campolongo, Cariboni and Saltelli 2007), sd, and the standard error of
/// mu_star. All NaN without a step, the last two with one.
struct MorrisEffect {
  double mu = nan, mu_star = nan, sigma = nan, mu_star_se = nan;
};

/// Trajectories in the unit cube, (d, trajectories (d + 1)): each from a random point of a grid of `levels` values, moving the parameters one after another, in
/// an order of its own, by levels / (2 (levels - 1)).
[[nodiscard]] Eigen::MatrixXd morris_design(std::size_t dimensions, std::size_t trajectories, int levels, std::uint64_t seed);

/// Effects from values (quantities, trajectories (d + 1)) at that design: [quantity][parameter]. Steps with a value that is
/// not finite are left out.
[[nodiscard]] std::vector<std::vector<MorrisEffect>> morris_effects(const Eigen::MatrixXd& design, const Eigen::MatrixXd& values);

}  // namespace calomel
