#pragma once
/// The posterior density of the parameters on one model, its mode by least squares, and its curvature from secants.
#include <Eigen/Core>
#include <atomic>
#include <optional>
#include <span>
#include <vector>

#include "forward/model.hpp"
#include "inverse/likelihood/likelihood.hpp"
#include "inverse/prior.hpp"

namespace calomel {

/// Search coordinates: the logarithm of parameters whose lower bound is positive or whose prior is lognormal, the parameter itself otherwise.
class SearchSpace {
 public:
  explicit SearchSpace(std::vector<Parameter> parameters);
  [[nodiscard]] Eigen::Index size() const { return low_.size(); }
  [[nodiscard]] const std::vector<Parameter>& parameters() const { return parameters_; }
  [[nodiscard]] const std::vector<Prior>& priors() const { return priors_; }
  [[nodiscard]] const Eigen::VectorXd& low() const { return low_; }
  [[nodiscard]] const Eigen::VectorXd& high() const { return high_; }
  [[nodiscard]] Eigen::VectorXd from(std::span<const double> theta) const;
  [[nodiscard]] std::vector<double> theta(const Eigen::VectorXd& x) const;
  /// d theta / d x, (n).
  [[nodiscard]] Eigen::VectorXd slope(const Eigen::VectorXd& x) const;
  /// Density whose mode is sought: of the parameter, but of its logarithm for a lognormal prior, where that is the symmetric one.
  [[nodiscard]] double log_prior(std::span<const double> theta) const;
  /// Numbers whose halved squares sum to a constant - log_prior, (n); 0 for uniform.
  [[nodiscard]] Eigen::VectorXd prior_residuals(const Eigen::VectorXd& x) const;
  /// Curvature of -log_prior by x (n), Gauss-Newton; 0 for uniform.
  [[nodiscard]] Eigen::MatrixXd prior_jacobian(const Eigen::VectorXd& x) const;
  /// d (mode coordinate) / d x, (n): 1 where the density is that of the logarithm and x is one, theta otherwise.
  [[nodiscard]] Eigen::VectorXd mode_slope(const Eigen::VectorXd& x) const;
  /// Standard deviation before the data, in x at `x`; a uniform prior's is its interval's over sqrt(12).
  [[nodiscard]] Eigen::VectorXd prior_sd(const Eigen::VectorXd& x) const;
  /// Half widths of secants in x that a rough model bears, (n): `sds` standard deviations, but not below `factor` times secant_scale; within a tenth of the box.
  [[nodiscard]] Eigen::VectorXd secant_widths(const Eigen::VectorXd& x, const Eigen::VectorXd& sds, double factor) const;

 private:
  std::vector<Parameter> parameters_;
  std::vector<Prior> priors_;
  std::vector<char> log_;
  std::vector<double> prior_top_;  ///< upper bound of the log density where its residual needs one
  Eigen::VectorXd low_, high_;
};

/// A model at a point with its secants.
struct Linearisation {
  Eigen::VectorXd x;
  Eigen::MatrixXd points;           ///< where the model was run, in x, (n, 2 n + 1), the middle last
  Eigen::VectorXd log_posteriors;   ///< there; -infinity where it failed
  Eigen::VectorXd residual;  ///< whitened, (p)
  Eigen::MatrixXd jacobian;  ///< of it by x, (p, n)
  double chi2 = 0;
};

/// A point of the posterior and what the model said there.
struct PosteriorPoint {
  std::vector<double> theta;
  std::vector<double> history;  ///< empty where the model failed
  double log_posterior = 0;     ///< SearchSpace::log_prior + log likelihood; -infinity where the model failed
};

class PosteriorMode {
 public:
  /// All outlive the object.
  PosteriorMode(const ForwardModel& model, const Likelihood& likelihood, const SearchSpace& space, int threads)
      : model_(model), likelihood_(likelihood), space_(space), threads_(threads) {}

  /// log posteriors at many points; thetas (n_parameters, m). -infinity where the model failed.
  [[nodiscard]] Eigen::VectorXd log_posteriors(const Eigen::MatrixXd& thetas) const;
  [[nodiscard]] PosteriorPoint at(const Eigen::VectorXd& x) const;

  /// Central secants along the columns of `steps` (n, n), shortened where they would leave the bounds; one-sided where the model fails on one
  /// side. Empty where it fails in the middle or on both sides. Costs 2 n + 1 runs.
  [[nodiscard]] std::optional<Linearisation> linearise(const Eigen::VectorXd& x, const Eigen::MatrixXd& steps) const;

  /// Gauss-Newton curvature of -log posterior: weight J'J + prior, (n, n).
  [[nodiscard]] Eigen::MatrixXd curvature(const Linearisation& at) const;

  /// A local mode by Ceres' Levenberg-Marquardt within the bounds; derivatives are secants with these half widths (n) in x.
  /// Empty where the model fails at `start`.
  struct Mode {
    Eigen::VectorXd x;
    double log_posterior = 0;
    int iterations = 0;
    bool converged = false;
  };
  [[nodiscard]] std::optional<Mode> find(const Eigen::VectorXd& start, const Eigen::VectorXd& half_widths) const;

  [[nodiscard]] bool is(const ForwardModel& model) const { return &model == &model_; }
  [[nodiscard]] std::size_t evaluations() const { return evaluations_; }
  [[nodiscard]] const Likelihood& likelihood() const { return likelihood_; }

 private:
  [[nodiscard]] Eigen::VectorXd log_posteriors_of(const Eigen::MatrixXd& thetas, const Eigen::MatrixXd& residuals) const;
  [[nodiscard]] Eigen::MatrixXf run(const Eigen::MatrixXd& thetas) const;
  const ForwardModel& model_;
  const Likelihood& likelihood_;
  const SearchSpace& space_;
  int threads_;
  mutable std::atomic<std::size_t> evaluations_{0};
};

/// How much of the drop of the log posterior that a covariance promises was seen at points run: sum of drops over sum of d' C^-1 d / 2, of
/// the points whose drop is below `greatest`; 1 where none tells. Below 1 the curvature by secants is steeper than the posterior is wide.
double seen_curvature(const Eigen::MatrixXd& points, const Eigen::VectorXd& log_posteriors, const Eigen::VectorXd& best, double log_posterior,
                      const Eigen::MatrixXd& covariance, double greatest = 50);

/// Inverse of a curvature with its reach kept within the box of a uniform prior: where a parameter's sd would exceed a quarter of its
/// interval, the interval's own variance is taken as information. `limited` tells whether that happened.
Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& curvature, const SearchSpace& space, const Eigen::VectorXd& x, bool& limited);

}  // namespace calomel
