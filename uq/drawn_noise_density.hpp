#pragma once
/// A case's posterior averaged over draws of the hyperparameters of the numerical noise, as a density for samplers.
#include <span>

#include "inverse/posterior/drawn_noise.hpp"
#include "uq/draws.hpp"
#include "uq/posterior_density.hpp"

namespace calomel {

/// The density ln p(q) = ln (1/B sum_b L_b(q)) + ln prior + ln |d(theta, k) / dq|, with L_b the likelihood under the hyperparameters of draw b. Its gradient is
/// the mean of theirs by the weights L_b / sum L. Coordinates and quantities are those of PosteriorDensity. The draws, one at least and all on one box with one
/// prior, outlive the object.
class DrawnNoiseDensity final : public LogDensity {
 public:
  explicit DrawnNoiseDensity(std::span<const DrawnNoise> draws);

  [[nodiscard]] const std::vector<std::string>& coordinates() const override { return first_.coordinates(); }
  [[nodiscard]] double log_density(std::span<const double> x) const override;
  [[nodiscard]] bool has_gradient() const override { return true; }
  double log_density_and_gradient(std::span<const double> x, std::span<double> gradient) const override;
  void constrain(std::span<const double> x, std::span<double> values) const override { first_.constrain(x, values); }

  /// The share of each draw of the hyperparameters in the likelihood at q: (draws).
  [[nodiscard]] std::vector<double> weights(const Eigen::VectorXd& q) const;

 private:
  std::span<const DrawnNoise> draws_;
  PosteriorDensity first_;
};

/// The change of a posterior by averaging over the draws of the hyperparameters.
struct NoiseInflation {
  std::vector<double> sd_ratio;        ///< (quantities) standard deviation of the draws over that under the estimate alone
  std::vector<double> sd_ratio_alike;  ///< (quantities) the same for the mean of the draws' posteriors, each with the same weight whatever the records favour
  std::vector<double> shift;           ///< (quantities) shift of the mean, in standard deviations under the estimate alone
  double plug_in_draws = 0;            ///< effective number of draws under the estimate, (sum w)^2 / sum w^2
  std::vector<double> weights;         ///< (hyperparameter draws) their shares in the posterior; they sum to 1
  double effective_draws = 0;          ///< effective number of hyperparameter draws, 1 / sum weights^2
};

/// Compares both posteriors. That under the estimate is represented by the same draws with the weights p_estimate / p, so that both have the same Monte Carlo
/// error; likewise those of each draw of the hyperparameters. coordinates, quantities: the sampler's draws, of which at most `most` evenly spaced ones are
/// taken.
[[nodiscard]] NoiseInflation noise_inflation(const DrawnNoiseDensity& density, const LogPosterior& estimate, const Draws& coordinates, const Draws& quantities,
                                             std::size_t most = 8000);

}  // namespace calomel
