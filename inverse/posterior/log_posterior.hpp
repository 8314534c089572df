#pragma once
/// The posterior density of the parameters and of the nuisances that are not linear, on the emulator, with its exact gradient.
#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "forward/emulator/multilevel.hpp"
#include "inverse/posterior/error_model.hpp"
#include "inverse/posterior/prior.hpp"

namespace calomel {

/// Normal prior of how far past the finest mesh the records lie.
struct BeyondPrior {
  double mean = 0, sd = 0;
};

/// One hypothesis about the errors of records, (size) values each: Gaussian, or Student's t where their scale was estimated from few squares.
struct RecordErrors {
  Eigen::MatrixXd covariance;  ///< (size, size)
  Eigen::VectorXd data;        ///< (size)
  double freedom;              ///< of the scale; infinity for a Gaussian
  double log_weight = 0;       ///< of its prior
};

/// log p(theta, k | records) = log L + log prior, with
///
///   L = sum_j w_j L_j,  log L_j = -1/2 sum_i [ln(1 + v l_i) + r_i^2 / (1 + v l_i)] + const,
///
/// r = A (records - emulator(theta, k)) in coordinates in which the covariance of the errors of hypothesis j is 1 and the numerical noise's is diag(l),
/// v(theta, k) the emulator's variance in units of that noise. (Student's t where the errors' scale was estimated from few squares.) There is one hypothesis,
/// or one for each scale and correlation time of a discrepancy, which is marginalised so.
///
/// Coordinates: the parameters that are free, then k where there are two meshes or more and its prior has a width. The box of the emulator is the support.
/// `q` are the unconstrained ones: the logit of each parameter's place in the box, and k itself.
class LogPosterior {
 public:
  /// coefficients: (size, coefficients) of the emulator's mean on the grid of `errors`; noise: (size, size), numerical noise of one run of the finest mesh.
  /// priors: as box.parameters(). Errors: NumericsError where a covariance is not positive definite.
  LogPosterior(EmulatorBox box, MultilevelRegression emulator, const Eigen::MatrixXd& coefficients, const std::vector<WeightedErrors>& errors,
               const Eigen::MatrixXd& noise, std::vector<Prior> priors, BeyondPrior beyond);
  LogPosterior(EmulatorBox box, MultilevelRegression emulator, const Eigen::MatrixXd& coefficients, const std::vector<RecordErrors>& errors,
               const Eigen::MatrixXd& noise, std::vector<Prior> priors, BeyondPrior beyond);

  /// The density with the likelihood to a power, of which log_density and mode_density are; density() and log_likelihood_of give the likelihood itself. power:
  /// > 0.
  [[nodiscard]] LogPosterior to_the_power(double power) const;

  /// Under some of the hypotheses about the errors (indices) alone, their weights over the sum of these.
  [[nodiscard]] LogPosterior part(const std::vector<std::size_t>& hypotheses) const;

  /// A nested hypothesis: the parameters named (index into the box, value) are held, and their priors do not count.
  [[nodiscard]] LogPosterior held(const std::vector<std::pair<Eigen::Index, double>>& values) const;

  [[nodiscard]] Eigen::Index dimension() const { return Eigen::Index(free_.size()) + (has_beyond_ ? 1 : 0); }
  [[nodiscard]] std::vector<std::string> names() const;
  /// Indices of the parameters that are free, into the box.
  [[nodiscard]] const std::vector<Eigen::Index>& free() const { return free_; }
  [[nodiscard]] const EmulatorBox& box() const { return box_; }
  [[nodiscard]] const MultilevelRegression& emulator() const { return emulator_; }
  [[nodiscard]] const std::vector<Prior>& priors() const { return priors_; }
  [[nodiscard]] const BeyondPrior& beyond_prior() const { return beyond_; }
  [[nodiscard]] bool has_beyond() const { return has_beyond_; }

  /// A point in all its forms.
  struct Point {
    Eigen::VectorXd u;  ///< of all parameters, in the box
    double beyond = 0;
    std::vector<double> theta;  ///< natural units
  };
  [[nodiscard]] Point point(const Eigen::VectorXd& q) const;
  /// The unconstrained coordinates of a point within the box; what lies on its edge is moved a part in 10^6 inwards.
  [[nodiscard]] Eigen::VectorXd q(std::span<const double> theta, double beyond) const;
  /// The point whose coordinate k, (u of a free parameter, or k), is moved.
  [[nodiscard]] Point moved(const Point& from, Eigen::Index k, double by) const;

  /// Parts of the density at a point, and their gradients by (u of the free parameters, k), (dimension).
  struct Density {
    double log_likelihood = 0;
    double log_prior = 0;           ///< of theta in natural units, and of k
    double chi2 = 0;                ///< sum r_i^2 / (1 + v l_i), of the likeliest hypothesis
    double variance = 0;            ///< v
    std::vector<double> log_terms;  ///< log w_j L_j of the hypotheses about the errors
    std::vector<double> weights;    ///< of those at this point; they sum to 1
    Eigen::VectorXd likelihood_gradient, prior_gradient;
    [[nodiscard]] double log_posterior() const { return log_likelihood + log_prior; }
  };
  /// with_gradients: without them likelihood_gradient is 0, and the call takes half the time.
  [[nodiscard]] Density density(const Point& point, bool with_gradients = true) const;
  /// log likelihood of another prediction of the records, (size) on the grid, with `variance` in place of the emulator's: a run of the finest mesh has 1.
  [[nodiscard]] double log_likelihood_of(const Eigen::VectorXd& prediction, double variance) const;

  /// Density by q: log L + log prior + log |d(theta, k) / dq|. `gradient` (dimension) is filled where it is requested.
  double log_density(const Eigen::VectorXd& q, Eigen::VectorXd* gradient = nullptr) const;
  /// Density whose top is the mode that is reported, as a function of q: log L + log prior, of the logarithm of a parameter with a lognormal prior.
  double mode_density(const Eigen::VectorXd& q, Eigen::VectorXd* gradient = nullptr) const;

  /// records - emulator at a point, whitened by the errors' covariance and the emulator's variance there, of one hypothesis, (size).
  [[nodiscard]] Eigen::VectorXd whitened_residual(const Point& point, std::size_t hypothesis) const;
  /// Directions on the grid in the same coordinates, (size, n).
  [[nodiscard]] Eigen::MatrixXd whiten(const Eigen::MatrixXd& directions, const Point& point, std::size_t hypothesis) const;
  /// Change of the prediction by (u of the free parameters, k), on the grid, (size, dimension).
  [[nodiscard]] Eigen::MatrixXd jacobian(const Point& point) const;
  [[nodiscard]] Eigen::Index values() const { return coefficients_.rows(); }
  /// How many hypotheses there are about the errors.
  [[nodiscard]] std::size_t hypotheses() const { return hypotheses_.size(); }
  /// Degrees of freedom of the errors' scale; infinity for a Gaussian.
  [[nodiscard]] double freedom(std::size_t hypothesis) const { return hypotheses_[hypothesis].freedom; }
  /// Index of the hypothesis about the errors with the greatest weight at a point.
  [[nodiscard]] std::size_t likeliest(const Point& point) const;

 private:
  struct Hypothesis {
    double log_weight, freedom, log_norm;
    Eigen::MatrixXd whitener;      ///< A, (size, size)
    Eigen::VectorXd data;          ///< A records
    Eigen::MatrixXd coefficients;  ///< A coefficients
    Eigen::VectorXd ratio;         ///< l, (size)
  };
  /// log L_j of a residual A_j r under a variance; its chi-squared, d log L_j / d(-chi2 / 2), and r / (1 + v l).
  struct Likelihood {
    double value, chi2, weight;
    Eigen::ArrayXd inflation, weighed;
  };
  [[nodiscard]] Likelihood likelihood(const Hypothesis& h, const Eigen::VectorXd& residual, double variance) const;
  /// Natural units; what is held is held to the bit, which the way to the box and back is not.
  [[nodiscard]] std::vector<double> theta_at(const Eigen::VectorXd& u) const;
  [[nodiscard]] double transform(const Eigen::VectorXd& q, bool jacobian, Eigen::VectorXd* gradient) const;
  EmulatorBox box_;
  MultilevelRegression emulator_;
  std::vector<Prior> priors_;
  BeyondPrior beyond_;
  bool has_beyond_;
  std::vector<Eigen::Index> free_;
  Eigen::VectorXd held_;                                     ///< u of all parameters; that of the free ones is not read
  std::vector<std::pair<std::size_t, double>> held_values_;  ///< index into the box, value
  Eigen::MatrixXd coefficients_;                             ///< (size, coefficients)
  std::vector<Hypothesis> hypotheses_;
  double power_ = 1;
};

}  // namespace calomel
