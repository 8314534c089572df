#pragma once
/// A case's posterior averaged over draws of the numerical noise's hyperparameters, as samplers take it.
#include <span>

#include "inverse/posterior/drawn_noise.hpp"
#include "uq/draws.hpp"
#include "uq/posterior_density.hpp"

namespace calomel {

/// ln p(q) = ln (1/B sum_b L_b(q)) + ln prior + ln |d(theta, k) / dq|, L_b the likelihood with the hyperparameters of draw b; its gradient is the mean of
/// theirs by the weights L_b / sum L. Coordinates and what is reported are those of PosteriorDensity. The draws, one at least and on one box with one prior,
/// outlive the object.
class DrawnNoiseDensity final : public LogDensity {
 public:
  explicit DrawnNoiseDensity(std::span<const DrawnNoise> draws);

  [[nodiscard]] const std::vector<std::string>& coordinates() const override { return first_.coordinates(); }
  [[nodiscard]] double log_density(std::span<const double> x) const override;
  [[nodiscard]] bool has_gradient() const override { return true; }
  double log_density_and_gradient(std::span<const double> x, std::span<double> gradient) const override;
  void constrain(std::span<const double> x, std::span<double> values) const override { first_.constrain(x, values); }

  /// Share of each draw of the hyperparameters in the likelihood at q, (draws).
  [[nodiscard]] std::vector<double> weights(const Eigen::VectorXd& q) const;

 private:
  std::span<const DrawnNoise> draws_;
  PosteriorDensity first_;
};

/// By how much the draws of the hyperparameters widen a posterior.
struct NoiseWidening {
  std::vector<double> sd_ratio;  ///< (quantities) sd of the draws over that under the estimate alone
  std::vector<double>
      sd_ratio_alike;           ///< the same if all draws of the hyperparameters counted alike, whatever the records say of them: the mean of their posteriors
  std::vector<double> shift;    ///< (quantities) of the mean, in sds under the estimate alone
  double plug_in_draws = 0;     ///< draws that those under the estimate are worth, (sum w)^2 / sum w^2
  std::vector<double> weights;  ///< (hyperparameter draws) their share in the posterior; they sum to 1
  double effective_draws = 0;   ///< 1 / sum weights^2
};

/// The posterior under the estimate is that of the same draws with the weights p_estimate / p, so that Monte Carlo errors of the two are one, and so are those
/// of each draw of the hyperparameters: `coordinates` and `quantities` of the sampler's draws, of which at most `most` evenly spaced ones are taken.
[[nodiscard]] NoiseWidening noise_widening(const DrawnNoiseDensity& density, const LogPosterior& estimate, const Draws& coordinates, const Draws& quantities,
                                           std::size_t most = 8000);

}  // namespace calomel
