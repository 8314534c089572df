#pragma once
/// Gaussian-process regression of one scalar (Rasmussen and Williams 2006, chapters 2 and 5) with a Matern 5/2 kernel,
/// one length scale a feature and a learned warp of every feature.
#include <Eigen/Core>

#include "base/instruction_set.hpp"
#include "base/linear_algebra.hpp"

namespace calomel {

/// Covariance of two outputs: variance (k(r) + nugget [x = x']), k(r) = (1 + sqrt5 r + 5/3 r^2) exp(-sqrt5 r),
/// r^2 = sum_j ((w_j - w'_j) / length_j)^2, with the feature warped to w = (1 - exp(-kappa x)) / (1 - exp(-kappa)).
/// On a logarithmic feature the warp gives every power of the parameter (kappa = -log(max/min): the parameter itself,
/// 0: its logarithm), so that travel times 1/c and lengths c are both straight lines to the kernel.
struct GaussianProcessHyperparameters {
  Eigen::VectorXd log_length;  ///< (features)
  Eigen::VectorXd kappa;       ///< (features)
  double log_nugget = -9;
  /// All in one vector: log_length, kappa, log_nugget.
  [[nodiscard]] Eigen::VectorXd packed() const;
  static GaussianProcessHyperparameters unpacked(const Eigen::VectorXd& p);
};

/// Warped feature and its derivatives; x in [0, 1] maps to [0, 1].
struct Warp {
  double value, by_x, by_kappa;
};
Warp warp(double x, double kappa);

/// Negative log posterior density of the hyperparameters: -log marginal likelihood with the variance at its optimum
/// (z' R^-1 z / n), plus weak normal priors (log_length about 0, sd 1.5; kappa about `kappa0`, sd 2; log_nugget about -8,
/// sd 4). x: (features, n) in [0, 1]; z: (n). `gradient` (by packed()) is filled where given. Infinite where R is not
/// positive definite.
double negative_log_posterior(const Eigen::MatrixXd& x, const Eigen::VectorXd& z, const Eigen::VectorXd& kappa0, const Eigen::VectorXd& packed,
                              Eigen::VectorXd* gradient);

/// Hyperparameters at the smallest `negative_log_posterior` found from `start` (L-BFGS, at most `iterations`).
GaussianProcessHyperparameters fit_hyperparameters(const Eigen::MatrixXd& x, const Eigen::VectorXd& z, const Eigen::VectorXd& kappa0,
                                                   const GaussianProcessHyperparameters& start, int iterations);

/// A process conditioned on its data; valid once constructed.
class GaussianProcess {
 public:
  GaussianProcess(const Eigen::MatrixXd& x, const Eigen::VectorXd& z, GaussianProcessHyperparameters hyperparameters);

  [[nodiscard]] const GaussianProcessHyperparameters& hyperparameters() const { return hyperparameters_; }
  [[nodiscard]] double variance_scale() const { return variance_; }
  /// Means at x: (features, m); result (m). The same to rounding by any instruction set.
  [[nodiscard]] Eigen::VectorXd means(const Eigen::MatrixXd& x, InstructionSet isa = instruction_set()) const;
  /// Gradient of the mean by x (features).
  [[nodiscard]] Eigen::VectorXd gradient(const Eigen::VectorXd& x) const;
  /// Predictive variance of a new run at x, its roughness (the nugget) included.
  [[nodiscard]] double variance(const Eigen::VectorXd& x) const;

 private:
  /// Features warped and divided by the length scales.
  [[nodiscard]] Eigen::MatrixXd scaled(const Eigen::MatrixXd& x) const;
  GaussianProcessHyperparameters hyperparameters_;
  Eigen::MatrixXd points_;  ///< scaled training features, (features, n)
  Cholesky factor_;
  Eigen::VectorXd weights_;  ///< R^-1 z
  // For the inner loop of means (see MaternProcess): sqrt5 times the points, transposed, and the weights, padded by zeros.
  Eigen::MatrixXd padded_points_;
  Eigen::VectorXd padded_weights_, stretch_;
  double variance_ = 0;
};

}  // namespace calomel
