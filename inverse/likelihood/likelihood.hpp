#pragma once
/// The likelihood of the mean records with all that is not the parameters' marginalised: one Gaussian, or multivariate t, for
/// calibration, samplers and diagnosis alike.
#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/linear_algebra.hpp"
#include "base/options.hpp"
#include "inverse/likelihood/mesh_error.hpp"
#include "inverse/likelihood/replicate_noise.hpp"
#include "inverse/posterior/error_model.hpp"

namespace calomel {

struct LikelihoodOptions {
  int values = 800;
  std::optional<double> band;
  double energy_scale_sd = 0.015;
  double gain_sd = 0.01;
  double baseline = 1;
  double coherent_noise = 0.1;
  double floor = 1;
  double floor_time = 2.5e-6;
  double floor_slow_time = 40e-6;
  double floor_slow_share = 0.25;

  template <class V>
  void visit(V& v) {
    v("values", values, {.range = between(10, 4000), .doc = "at most so many values of all gauges; records and simulations are decimated to them by one filter"});
    v("band", band,
      {.unit = "Hz", .range = above(0), .doc = "frequency up to which records are compared; default: 40 m/s over the element size, beyond which waves on the mesh are too slow"});
    v("energy_scale_sd", energy_scale_sd, {.range = between(0, 0.5), .doc = "relative sd of the absolute pulse energy, common to all gauges; marginalised"});
    v("gain_sd", gain_sd, {.range = between(0, 0.5), .doc = "relative sd of each gauge's gain; marginalised"});
    v("baseline", baseline, {.range = at_least(0), .doc = "sd of each gauge's baseline in units of its noise; marginalised"});
    v("coherent_noise", coherent_noise, {.range = between(0, 1), .doc = "sd of the part of the noise that all pulses share, over that of one pulse"});
    v("floor", floor, {.range = at_least(0), .doc = "factor on the repeatability floor; 0 leaves it out"});
    v("floor_time", floor_time,
      {.unit = "s", .range = above(0), .doc = "correlation time along the record of the greater part of the repeatability floor and of the surrogate's error"});
    v("floor_slow_time", floor_slow_time, {.unit = "s", .range = above(0), .doc = "that of the rest"});
    v("floor_slow_share", floor_slow_share, {.range = between(0, 1), .doc = "share of the rest in the variance"});
  }
};

/// What is known of the model's own errors, each (values of the model) or empty.
struct ModelError {
  Eigen::VectorXd floor_variance;      ///< of the ensemble mean when mesh, viscosity and energies are jittered
  Eigen::VectorXd surrogate_variance;  ///< of (model - surrogate); empty for the true model
  Eigen::VectorXd energy_slope;        ///< secant of the mean by relative pulse energy
  MeshError mesh;                      ///< its shift is added to predictions
  Eigen::MatrixXd unknowns;            ///< (values, k): change by one sd of each nuisance of the target and its gauges
  Eigen::MatrixXd mesh_known;          ///< MeshError::Spread::known where the likelihood is used
};

/// Discrepancy of scale 1: what the covariance is per squared scale. See `discrepancy_shape`.
struct DiscrepancyOptions {
  double scale = 0.1;
  double time = 15e-6;
  double distance = 0.03;

  template <class V>
  void visit(V& v) {
    v("scale", scale, {.range = above(0), .doc = "scale of the half-normal prior of the discrepancy over the local amplitude"});
    v("time", time, {.unit = "s", .range = above(0), .doc = "correlation time of the discrepancy (Matern 3/2)"});
    v("distance", distance, {.unit = "m", .range = above(0), .doc = "distance over which neighbouring gauges share it, exp(-distance)"});
  }
};

/// A multivariate Gaussian, or Student t where its scale was learnt from few squares.
class ErrorDistribution {
 public:
  /// `freedom`: of the scale; infinity is the Gaussian. Errors: NumericsError when the covariance is not positive definite.
  ErrorDistribution(const Eigen::MatrixXd& covariance, double freedom);

  [[nodiscard]] Eigen::Index size() const { return factor_.size(); }
  [[nodiscard]] double freedom() const { return freedom_; }
  /// L^-1 r, of unit covariance; columns at once.
  [[nodiscard]] Eigen::MatrixXd whiten(const Eigen::MatrixXd& residuals) const { return factor_.solve_lower(residuals); }
  [[nodiscard]] double chi2(const Eigen::VectorXd& residual) const { return whiten(residual).col(0).squaredNorm(); }
  /// log density at a residual of this chi2.
  [[nodiscard]] double log_density_at(double chi2) const;
  [[nodiscard]] double log_density(const Eigen::VectorXd& residual) const { return log_density_at(chi2(residual)); }
  /// Gradient of the log density by the residual.
  [[nodiscard]] Eigen::VectorXd gradient(const Eigen::VectorXd& residual) const;
  /// d log density / d(-chi2/2): 1 for the Gaussian.
  [[nodiscard]] double weight(double chi2) const;
  [[nodiscard]] const Eigen::VectorXd& variance() const { return variance_; }
  /// Effective number of independent data: p^2 / |R|_F^2, R the correlation matrix of the p values. The mean of r_i^2 / Sigma_ii has
  /// the mean 1 and the variance 2 / (this number) for Gaussian r (Satterthwaite 1946): p for independent values, 1 for identical ones.
  [[nodiscard]] double effective_data() const { return effective_data_; }
  /// effective_data() times the mean of r_i^2 / Sigma_ii: about chi-squared with effective_data() degrees of freedom, and unlike
  /// chi2 blind to how well the correlations are known.
  [[nodiscard]] double effective_chi2(const Eigen::VectorXd& residual) const;

 private:
  Cholesky factor_;
  Eigen::VectorXd variance_;
  double freedom_ = 0, log_norm_ = 0, effective_data_ = 0;
};

/// The likelihood of mean records. Valid once constructed; immutable, safe from many threads.
class Likelihood {
 public:
  /// Errors: InputError for a single pulse without noise; NumericsError for a singular covariance.
  Likelihood(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options, const LikelihoodOptions& options,
             const ModelError& model_error);

  [[nodiscard]] const Decimation& grid() const { return grid_; }
  [[nodiscard]] const ReplicateNoise& noise() const { return noise_; }
  [[nodiscard]] const ErrorDistribution& errors() const { return *errors_; }
  /// Mean records, (grid().size()); those of gauges with other pulses than the rest are carried to mean energy 1.
  [[nodiscard]] const Eigen::VectorXd& data() const { return data_; }
  /// Covariance of all, (size, size).
  [[nodiscard]] const Eigen::MatrixXd& covariance() const { return covariance_; }
  /// Shares of the covariance's trace, by source.
  [[nodiscard]] const std::vector<std::pair<std::string, double>>& shares() const { return shares_; }

  /// The same with another term added to the covariance, (size, size), under a name of its own among the shares.
  [[nodiscard]] Likelihood with(const std::string& source, const Eigen::MatrixXd& extra) const;

  /// The same with the mean of its covariance and another's, which is of the same data: one yardstick for two explanations. The shares are those of the sum.
  /// Errors: contract failure for other data.
  [[nodiscard]] Likelihood mean_with(const Likelihood& other) const;
  /// The same with the records moved, by (size).
  [[nodiscard]] Likelihood moved(const Eigen::VectorXd& by) const;
  /// The same for histories that have the mesh's shift in them already.
  [[nodiscard]] Likelihood without_shift() const;

  /// data - (model + mesh shift). history: (values of the model).
  [[nodiscard]] Eigen::VectorXd residual(std::span<const double> theta, std::span<const double> history) const;
  /// The same for columns; thetas: (n_parameters, n), histories: (values, n).
  [[nodiscard]] Eigen::MatrixXd residuals(const Eigen::MatrixXd& thetas, const Eigen::MatrixXf& histories) const;
  [[nodiscard]] double log_likelihood(std::span<const double> theta, std::span<const double> history) const;
  /// Gradient of the log likelihood by the model's values: the weights of ForwardModel::pull_back (the mesh shift's own slope left out).
  [[nodiscard]] Eigen::VectorXd gradient(std::span<const double> theta, std::span<const double> history) const;

 private:
  Decimation grid_;
  ReplicateNoise noise_;
  MeshError mesh_;
  Eigen::VectorXd data_;
  Eigen::MatrixXd covariance_;
  std::vector<std::pair<std::string, double>> shares_;
  void distribute();
  double noise_trace_ = 0, noise_freedom_ = 0;
  std::optional<ErrorDistribution> errors_;
};

}  // namespace calomel
