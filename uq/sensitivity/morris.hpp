#pragma once
/// Elementary effects (Morris 1991, Technometrics 33, 161), which show with few runs which parameters matter and which act linearly.
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "base/not_finite.hpp"

namespace calomel {

/// The effects of one parameter on one quantity, over the parameter's range [unit of the quantity]. All are NaN without a step; sigma and mu_star_se are NaN
/// with a single one.
struct MorrisEffect {
  double mu = nan;          ///< mean
  double mu_star = nan;     ///< mean of the absolute values (Campolongo, Cariboni and Saltelli 2007)
  double sigma = nan;       ///< standard deviation
  double mu_star_se = nan;  ///< standard error of mu_star
};

/// Trajectories in the unit cube, (d, trajectories (d + 1)). Each starts at a random point of a grid of `levels` values and moves the parameters one after
/// another, in a random order, by levels / (2 (levels - 1)).
[[nodiscard]] Eigen::MatrixXd morris_design(std::size_t dimensions, std::size_t trajectories, int levels, std::uint64_t seed);

/// The effects [quantity][parameter] from values (quantities, trajectories (d + 1)) at that design. Steps with a value that is not finite are left out.
[[nodiscard]] std::vector<std::vector<MorrisEffect>> morris_effects(const Eigen::MatrixXd& design, const Eigen::MatrixXd& values);

}  // namespace calomel
