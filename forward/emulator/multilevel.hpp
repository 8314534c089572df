#pragma once
/// One emulator over all meshes: runs of the true model at several element sizes and one viscosity for all, by regression on the parameters.
#include <Eigen/Core>
#include <span>
#include <vector>

#include "forward/parameter.hpp"

namespace calomel {

/// The box that an emulator holds in, and its coordinates u in [-1, 1]^d: those of the parameters (Parameter::coordinate) about the box's
/// middle over its half width.
class EmulatorBox {
 public:
  EmulatorBox() = default;
  /// low, high: (n_parameters), natural units, within the parameters' bounds. Errors: contract failure for an empty interval.
  EmulatorBox(std::vector<Parameter> parameters, std::span<const double> low, std::span<const double> high);

  [[nodiscard]] Eigen::Index size() const { return centre_.size(); }
  [[nodiscard]] const std::vector<Parameter>& parameters() const { return parameters_; }
  [[nodiscard]] Eigen::VectorXd u(std::span<const double> theta) const;
  [[nodiscard]] std::vector<double> theta(const Eigen::VectorXd& u) const;
  /// d theta / d u, (n).
  [[nodiscard]] Eigen::VectorXd derivative(const Eigen::VectorXd& u) const;
  /// Whether theta lies within, to a part in 10^9.
  [[nodiscard]] bool contains(std::span<const double> theta) const { return u(theta).cwiseAbs().maxCoeff() <= 1 + 1e-9; }
  /// The nearest point within.
  [[nodiscard]] std::vector<double> nearest(std::span<const double> theta) const;

 private:
  std::vector<Parameter> parameters_;
  Eigen::VectorXd centre_, half_width_;
};

/// Training runs.
struct EmulatorRuns {
  Eigen::MatrixXd u;       ///< (n_parameters, runs), coordinates of the box
  std::vector<int> level;  ///< (runs): 0 the finest mesh, 1 the next coarser one, ...
  int levels = 1;
};

/// z(u) of the finest mesh and of the coarser ones as one regression: level 0 is phi(u) . beta, level l phi(u) . beta + psi(u) . gamma_l, with phi the
/// polynomials of order two and psi = (1, u). All levels determine beta; coarse and fine runs, paired or not, determine gamma. What a run has beyond that, e,
/// is numerical noise of its own mesh, of variance s_l^2 times the same covariance for all levels; it is never predicted. The weights with which runs make a
/// prediction are the same for every output, so that one object serves whole histories, decimated ones and energy slopes.
///
/// `beyond` k leads past the finest mesh along the last difference: z_0 + k (z_0 - z_1); -1 is the next coarser mesh, 0 the finest.
class MultilevelRegression {
 public:
  MultilevelRegression() = default;
  /// outputs: (n_outputs, runs), on which the levels' noise is judged, e.g. decimated histories; weights: (n_outputs), of an output's square in that
  /// judgement. Errors: contract failure for shapes that differ, or fewer runs than coefficients.
  MultilevelRegression(const EmulatorRuns& runs, const Eigen::MatrixXd& outputs, const Eigen::VectorXd& weights);

  /// Number of coefficients of a model of so many parameters and levels: what a design needs at least, and of the finest level 1 + n_parameters.
  static Eigen::Index coefficients(Eigen::Index parameters, int levels) { return (parameters + 1) * (parameters + 2) / 2 + (levels - 1) * (parameters + 1); }

  [[nodiscard]] Eigen::Index size() const { return features_.cols(); }
  [[nodiscard]] int levels() const { return levels_; }
  /// (coefficients) at u, `beyond` the finest mesh.
  [[nodiscard]] Eigen::VectorXd features(const Eigen::VectorXd& u, double beyond) const;
  /// Its derivatives by u and, in the last column, by `beyond`, (coefficients, n_parameters + 1).
  [[nodiscard]] Eigen::MatrixXd features_slope(const Eigen::VectorXd& u, double beyond) const;
  /// Features of a run's own level, (coefficients).
  [[nodiscard]] Eigen::VectorXd level_features(const Eigen::VectorXd& u, int level) const;
  /// Least-squares coefficients of outputs (n_outputs, runs): (n_outputs, coefficients). A prediction is this times features().
  [[nodiscard]] Eigen::MatrixXd fit(const Eigen::MatrixXd& outputs) const { return outputs * gain_.transpose(); }
  /// Weights of the runs in a prediction, (runs).
  [[nodiscard]] Eigen::VectorXd weights(const Eigen::VectorXd& features) const { return gain_.transpose() * features; }
  /// Variance of a prediction over that of the numerical noise of one finest run: features' H features.
  [[nodiscard]] double variance(const Eigen::VectorXd& features) const { return features.dot(inverse_ * features); }
  /// H, (coefficients, coefficients).
  [[nodiscard]] const Eigen::MatrixXd& inverse() const { return inverse_; }
  /// s_l^2 / s_0^2, (levels).
  [[nodiscard]] const std::vector<double>& noise_ratio() const { return noise_ratio_; }
  /// Variance of each level's noise, (levels), from the squares of the runs' residuals and from what the fit leaves of each square, 1 - leverage, (runs) both:
  /// the sum of squares over the sum of what is left, over the level's runs, leaning by a quarter of a run on those of all levels.
  [[nodiscard]] std::vector<double> level_noise(const Eigen::VectorXd& squares, const Eigen::VectorXd& left) const;
  /// The same runs, weighed by another noise of the levels, s_l^2 / s_0^2 (levels).
  [[nodiscard]] MultilevelRegression with_noise_ratio(const std::vector<double>& ratio) const;
  /// Share of each run's square that the fit takes away, (runs), below 1.
  [[nodiscard]] const Eigen::VectorXd& leverage() const { return leverage_; }
  /// outputs - fit, each run over its level's s_l / s_0, (n_outputs, runs): as of finest runs.
  [[nodiscard]] Eigen::MatrixXd residuals(const Eigen::MatrixXd& outputs) const;
  /// What each run would be missed by if it were left out, (n_outputs, runs): (outputs - fit) / (1 - leverage).
  [[nodiscard]] Eigen::MatrixXd left_out(const Eigen::MatrixXd& outputs) const;
  /// Squares left in the residuals: runs less coefficients.
  [[nodiscard]] double freedom() const { return double(features_.cols() - features_.rows()); }
  /// Places of the runs of a level, (n_parameters, runs of the level).
  [[nodiscard]] Eigen::MatrixXd points(int level) const;
  /// The same and a further run at `u` of `level`: what variance() will be, whatever the run gives.
  [[nodiscard]] MultilevelRegression with_run(const Eigen::VectorXd& u, int level) const;

 private:
  /// Least squares of runs with the variance noise[level], (levels): inverse_, gain_ and leverage_.
  void weigh(const std::vector<double>& noise);
  int levels_ = 1;
  Eigen::Index parameters_ = 0;
  std::vector<int> level_;
  Eigen::MatrixXd features_;  ///< (coefficients, runs)
  Eigen::MatrixXd inverse_, gain_;
  Eigen::VectorXd leverage_;  ///< (runs)
  std::vector<double> noise_ratio_;
};

}  // namespace calomel
