#pragma once
/// Where a density is greatest: all modes that a search over its support finds, so that chains begin in each of them and not in the nearest alone.
#include <Eigen/Core>
#include <vector>

#include "uq/log_density.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel {

struct LaplaceMode {
  Eigen::VectorXd x;           ///< (d)
  Eigen::MatrixXd covariance;  ///< (d, d): inverse of the curvature there; of a direction without any, the square of `unknown_sd`
  double log_density = 0;
  double weight = 0;  ///< share of the probability by Laplace's approximation, among the modes told
  static constexpr double unknown_sd = 1;
};

/// Distinct modes, the greatest weight first; those below 1e-5 of it are left out.
///
/// Descents begin at `starts` and at those points of `design` that are above all their nearest neighbours there (Törn and Viitanen 1992, in Recent Advances in
/// Global Optimization, 384), at most 16: BFGS with a strong Wolfe line search (Ceres), the density's gradient or central differences. Two ends are one mode
/// where the density between them does not fall by more than 1 below the lower one. The curvature is by second differences of the density, over a third of the
/// deviations that a first pass finds. design: (d, n), and starts: (d, m), in the density's coordinates. Errors: NumericsError where the density is zero at all
/// of them.
[[nodiscard]] std::vector<LaplaceMode> density_modes(const LogDensity& density, const Eigen::MatrixXd& design, const Eigen::MatrixXd& starts, int threads);

/// Chains that begin about each mode in turn, and may jump between them.
[[nodiscard]] SamplerStart start_at_modes(const std::vector<LaplaceMode>& modes);

}  // namespace calomel
