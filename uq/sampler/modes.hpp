#pragma once
/// All modes of a density that a search over its support finds, so that chains begin in each of them and not only in the nearest.
#include <Eigen/Core>
#include <vector>

#include "uq/log_density.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel {

/// A mode with its Laplace approximation.
struct LaplaceMode {
  Eigen::VectorXd x;           ///< (d)
  Eigen::MatrixXd covariance;  ///< (d, d): inverse of the curvature there; the square of `unknown_sd` in a direction without curvature
  double log_density = 0;
  double weight = 0;  ///< share of the probability of all modes found, by Laplace's approximation
  static constexpr double unknown_sd = 1;
};

/// Finds the distinct modes, the greatest weight first. Modes below 1e-5 of the greatest weight are left out.
///
/// Searches begin at `starts` and at up to 16 points of `design` whose density exceeds that of all their nearest neighbours (Törn and Viitanen 1992, in Recent
/// Advances in Global Optimization, 384). Each is BFGS with a strong Wolfe line search (Ceres) on the density's gradient or on central differences. Two ends
/// count as one mode where the log density between them does not fall by more than 1 below the lower one. The curvature comes from second differences of the
/// density over a third of the standard deviations that a first pass finds. design: (d, n), and starts: (d, m), in the density's coordinates. Errors:
/// NumericsError where the density is zero at all of them.
[[nodiscard]] std::vector<LaplaceMode> density_modes(const LogDensity& density, const Eigen::MatrixXd& design, const Eigen::MatrixXd& starts, int threads);

/// Starts about each mode in turn, from which chains may jump between the modes.
[[nodiscard]] SamplerStart start_at_modes(const std::vector<LaplaceMode>& modes);

}  // namespace calomel
