#pragma once
/// Ordinary kriging of many outputs with one correlation: a prediction is a weighted sum of what was seen, the same weights for all outputs.
#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <vector>

#include "base/linear_algebra.hpp"
#include "base/random.hpp"
#include "forward/parameter.hpp"

namespace calomel {

/// d(theta) = m + z(theta): an unknown constant and a Gaussian process of correlation exp(-sum_k ((u_k - u'_k) / l_k)^2 / 2), u the parameters scaled to
/// their bounds (by their logarithms where the lower bound is positive), and independent scatter of `nugget` times its variance. Long lengths make it the
/// low-order polynomial through the points (Driscoll and Fornberg 2002). Lengths and nugget maximise the restricted likelihood of all outputs pooled
/// (Harville 1974) times a lognormal prior of the lengths, so that a few points do not make them extreme.
class Kriging {
 public:
  Kriging() = default;
  /// theta: (n_parameters, n), n >= 2; outputs: (values, n). Errors: contract failure for other shapes.
  Kriging(std::vector<Parameter> parameters, const Eigen::MatrixXd& theta, const Eigen::MatrixXd& outputs);

  [[nodiscard]] bool empty() const { return points_.size() == 0; }
  [[nodiscard]] Eigen::Index size() const { return points_.cols(); }
  /// Best linear unbiased weights of the seen outputs, (n); they sum to 1.
  [[nodiscard]] Eigen::VectorXd weights(std::span<const double> theta) const;
  /// The same at many points. thetas: (n_parameters, m); result: (n, m).
  [[nodiscard]] Eigen::MatrixXd weights_at(const Eigen::MatrixXd& thetas) const;
  /// Gradient of weights(theta) . seen by theta, (n_parameters); seen: (n).
  [[nodiscard]] Eigen::VectorXd slope(std::span<const double> theta, const Eigen::VectorXd& seen) const;
  /// Variance of one more seen output about the prediction, scatter included, over the process's variance.
  [[nodiscard]] double variance_factor(std::span<const double> theta) const;
  /// Variance of the smooth part, m + z, about the prediction, over the process's variance: without one more output's own scatter.
  [[nodiscard]] double smooth_variance_factor(std::span<const double> theta) const { return std::max(0.0, variance_factor(theta) - nugget_); }
  /// (n, n - 1) matrix A such that outputs A A' outputs' is the process's covariance between outputs, restricted maximum likelihood.
  [[nodiscard]] const Eigen::MatrixXd& residual_root() const { return root_; }
  [[nodiscard]] const Eigen::VectorXd& lengths() const { return lengths_; }
  [[nodiscard]] double nugget() const { return nugget_; }
  /// Parameters in the coordinates of the correlation, (n_parameters).
  [[nodiscard]] Eigen::VectorXd scaled(std::span<const double> theta) const;
  /// The points that were seen, scaled, (n_parameters, n).
  [[nodiscard]] const Eigen::MatrixXd& points() const { return points_; }

 private:
  [[nodiscard]] Eigen::MatrixXd correlation(const Eigen::VectorXd& lengths, double nugget) const;
  /// -2 log restricted likelihood of the pooled outputs, whose Gram matrix is `gram` (n, n); infinity where the correlation is singular.
  [[nodiscard]] double deviance(const Eigen::VectorXd& lengths, double nugget, const Eigen::MatrixXd& gram) const;
  void fit(const Eigen::MatrixXd& gram);
  std::vector<Parameter> parameters_;
  Eigen::MatrixXd points_;  ///< scaled, (n_parameters, n)
  Eigen::VectorXd lengths_;
  double nugget_ = 0;
  Cholesky factor_;
  Eigen::VectorXd ones_;  ///< R^-1 1
  Eigen::MatrixXd root_;
};

/// One draw of what a kriging misses of the smooth process, as a function of the parameters: conditional simulation, a realisation less its own kriging from
/// the seen points, scatter included (Journel and Huijbregts 1978, ch. VII). Realisations are sums of waves with random frequencies (Rahimi and Recht 2007).
class KrigingError {
 public:
  /// `fields` independent draws. The kriging outlives the object.
  KrigingError(const Kriging& kriging, Eigen::Index fields, RandomStream& random);
  /// (fields), each of mean 0 and variance smooth_variance_factor(theta), in units of the process's deviation.
  [[nodiscard]] Eigen::VectorXd at(std::span<const double> theta) const;

 private:
  [[nodiscard]] Eigen::VectorXd realisation(const Eigen::VectorXd& scaled) const;
  const Kriging& kriging_;
  Eigen::MatrixXd frequencies_;  ///< (waves, n_parameters)
  Eigen::MatrixXd amplitudes_;   ///< (fields, 2 waves)
  Eigen::MatrixXd seen_;         ///< the realisation at the seen points, (fields, n)
};

}  // namespace calomel
