#pragma once
/// The modes of a posterior, each with the Gaussian of Laplace about it.
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "inverse/posterior/log_posterior.hpp"

namespace calomel {

/// A mode of LogPosterior::mode_density.
struct LocalMode {
  Eigen::VectorXd q;
  LogPosterior::Point at;
  double log_posterior = 0;  ///< log likelihood + log prior there
  double mode_density = 0;
  Eigen::MatrixXd
      covariance;       ///< of (u of the free parameters, k), (dimension, dimension): inverse of the curvature of log L + log prior of the box's coordinates
  double gradient = 0;  ///< largest derivative of the density along a coordinate, times its standard deviation
  int iterations = 0;
};

/// A point as a mode: its densities and the Gaussian about it.
LocalMode mode_at(const LogPosterior& posterior, const Eigen::VectorXd& q);

/// Distinct local modes from the starts given, best first; starts: q. Ceres, BFGS with a strong Wolfe line search on the exact gradient.
std::vector<LocalMode> find_modes(const LogPosterior& posterior, const std::vector<Eigen::VectorXd>& starts);

/// Logarithm of the evidence by Laplace: log L + log prior of theta at the mode + log of the Gaussian's volume in theta (and k).
double log_evidence(const LogPosterior& posterior, const LocalMode& mode);

/// Covariance of theta (natural units), of the free parameters.
Eigen::MatrixXd parameter_covariance(const LogPosterior& posterior, const LocalMode& mode);

/// Draws from the Gaussian about a mode, `widening` times its deviations, that lie in the box: (n_parameters + 1, n), u of all parameters and k.
/// Fewer where hardly any do.
Eigen::MatrixXd gaussian_draws(const LogPosterior& posterior, const LocalMode& mode, std::size_t n, std::uint64_t seed, double inflation = 1);

}  // namespace calomel
