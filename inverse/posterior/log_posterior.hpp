#pragma once
/// The posterior density of the parameters and of the nuisances that are not linear, on the emulator, with its exact gradient.
#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "forward/emulator/multilevel.hpp"
#include "inverse/posterior/error_model.hpp"
#include "inverse/prior.hpp"

namespace calomel {

/// Normal prior of how far past the finest mesh the records lie.
struct BeyondPrior {
  double mean = 0.25, sd = 0.25;
};

/// log p(theta, k | records) = log L + log prior, with
///
///   log L = -1/2 sum_i [ln(1 + v l_i) + r_i^2 / (1 + v l_i)] + const,
///
/// r = A (records - emulator(theta, k)) in coordinates in which the errors' covariance is 1 and the numerical noise's is diag(l), v(theta, k) the emulator's
/// variance in units of that noise. (Student's t where the errors' scale was learnt from few squares.)
///
/// Coordinates: theta, then k where there are two meshes or more and its prior has a width. The box of the emulator is the support. `q` are the
/// unconstrained ones: the logit of each parameter's place in the box, and k itself.
class LogPosterior {
 public:
  /// coefficients: (size, coefficients) of the emulator's mean on the grid of `errors`; noise: (size, size), numerical noise of one run of the finest mesh.
  /// priors: as box.parameters(). Errors: NumericsError where the covariance is not positive definite.
  LogPosterior(EmulatorBox box, MultilevelRegression emulator, const Eigen::MatrixXd& coefficients, const ErrorModel& errors, const Eigen::MatrixXd& noise,
               std::vector<Prior> priors, BeyondPrior beyond);

  [[nodiscard]] Eigen::Index dimension() const { return box_.size() + (has_beyond_ ? 1 : 0); }
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] const EmulatorBox& box() const { return box_; }
  [[nodiscard]] const MultilevelRegression& emulator() const { return emulator_; }
  [[nodiscard]] const std::vector<Prior>& priors() const { return priors_; }
  [[nodiscard]] const BeyondPrior& beyond_prior() const { return beyond_; }
  [[nodiscard]] bool has_beyond() const { return has_beyond_; }

  /// A point in all its forms.
  struct Point {
    Eigen::VectorXd u;          ///< of the parameters, in the box
    double beyond = 0;
    std::vector<double> theta;  ///< natural units
  };
  [[nodiscard]] Point point(const Eigen::VectorXd& q) const;
  /// The unconstrained coordinates of a point within the box; what lies on its edge is moved a part in 10^6 inwards.
  [[nodiscard]] Eigen::VectorXd q(std::span<const double> theta, double beyond) const;

  /// Parts of the density at a point, and their gradients by (u, k), (dimension).
  struct Density {
    double log_likelihood = 0;
    double log_prior = 0;        ///< of theta in natural units, and of k
    double chi2 = 0;             ///< sum r_i^2 / (1 + v l_i)
    double variance = 0;         ///< v
    Eigen::VectorXd likelihood_gradient, prior_gradient;
    [[nodiscard]] double log_posterior() const { return log_likelihood + log_prior; }
  };
  [[nodiscard]] Density density(const Point& point) const;

  /// Density by q: log L + log prior + log |d(theta, k) / dq|. `gradient` (dimension) is filled where it is asked for.
  double log_density(const Eigen::VectorXd& q, Eigen::VectorXd* gradient = nullptr) const;
  /// Density whose top is the mode that is reported, as a function of q: log L + log prior, of the logarithm of a parameter with a lognormal prior.
  double mode_density(const Eigen::VectorXd& q, Eigen::VectorXd* gradient = nullptr) const;

  /// records - emulator at a point, whitened by the errors' covariance and the emulator's variance there, (size).
  [[nodiscard]] Eigen::VectorXd whitened_residual(const Point& point) const;
  /// Any direction on the grid in the same coordinates, (size, n).
  [[nodiscard]] Eigen::MatrixXd whiten(const Eigen::MatrixXd& directions, double variance) const;
  [[nodiscard]] Eigen::Index values() const { return data_.size(); }
  /// Eigenvalues of the numerical noise over the errors' covariance, ascending.
  [[nodiscard]] const Eigen::VectorXd& noise_ratio() const { return ratio_; }

 private:
  [[nodiscard]] double transform(const Eigen::VectorXd& q, bool jacobian, Eigen::VectorXd* gradient) const;
  EmulatorBox box_;
  MultilevelRegression emulator_;
  std::vector<Prior> priors_;
  BeyondPrior beyond_;
  bool has_beyond_;
  double freedom_, log_norm_;
  Eigen::MatrixXd whitener_;      ///< A, (size, size)
  Eigen::VectorXd data_;          ///< A records
  Eigen::MatrixXd coefficients_;  ///< A coefficients
  Eigen::VectorXd ratio_;         ///< l, (size)
};

}  // namespace calomel
