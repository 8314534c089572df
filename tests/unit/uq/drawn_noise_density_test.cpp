// The posterior averaged over draws of the numerical noise's hyperparameters.
#include "uq/drawn_noise_density.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/uq/experiment.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/posterior_moments.hpp"

namespace calomel {
namespace {

struct Fitted {
  Experiment experiment{0, 0, 0, 1, 1};
  PosteriorInputs in = experiment.base();
  PosteriorFit fit;
  Fitted() {
    in.discrepancy = false;
    in.run = [](const Eigen::MatrixXd& thetas, const std::vector<int>& level) {
      std::vector<RunRecord> all;
      for (std::size_t i = 0; i < level.size(); ++i) all.push_back(Experiment::run(thetas.col(Eigen::Index(i)), level[i], {}, 2e-6));
      return all;
    };
    fit = fit_posterior(in);
  }
  [[nodiscard]] Eigen::VectorXd beside_the_mode(double by) const { return fit.modes[0].q + by * Eigen::VectorXd::Ones(fit.modes[0].q.size()); }
  /// The posterior with `factor` times the noise, as if it had been drawn so.
  [[nodiscard]] DrawnNoise scaled(double factor) const {
    std::vector<WeightedErrors> errors = fit.hypotheses;
    for (auto& h : errors) h.errors = h.errors.without(record_noise_term).with({record_noise_term, factor * fit.noise});
    const LogPosterior& p = *fit.posterior;
    return {.posterior = {p.box(), p.emulator(), fit.coefficients, errors, factor * fit.noise, p.priors(), p.beyond_prior()},
            .noise_ratio = p.emulator().noise_ratio(),
            .scale = factor};
  }
};

}  // namespace

TEST(DrawnNoiseDensity, IsTheMeanOfTheLikelihoodsWithItsExactGradient) {
  const Fitted f;
  const auto drawn = draw_noise(f.in, f.fit, 4, 5, 1);
  ASSERT_EQ(drawn.size(), 4u);
  const DrawnNoiseDensity density(drawn);
  const Eigen::VectorXd q = f.beside_the_mode(0.02);
  const auto at = f.fit.posterior->point(q);
  double sum = 0, highest = -1e300;
  for (const auto& d : drawn) highest = std::max(highest, d.posterior.density(at).log_likelihood);
  for (const auto& d : drawn) sum += std::exp(d.posterior.density(at).log_likelihood - highest) / 4;
  const double likelihood = highest + std::log(sum),
               jacobian = f.fit.posterior->log_density(q) - f.fit.posterior->density(at).log_likelihood;  // and the prior: one for all
  EXPECT_NEAR(density.log_density({q.data(), 3}), likelihood + jacobian, 1e-9 * std::abs(likelihood));
  std::vector<double> gradient(3);
  EXPECT_EQ(density.log_density_and_gradient({q.data(), 3}, gradient), density.log_density({q.data(), 3}));
  for (Eigen::Index k = 0; k < 3; ++k) {
    Eigen::VectorXd up = q, down = q;
    up[k] += 1e-5;
    down[k] -= 1e-5;
    const double difference = (density.log_density({up.data(), 3}) - density.log_density({down.data(), 3})) / 2e-5;
    EXPECT_NEAR(gradient[std::size_t(k)], difference, 1e-4 * (1 + std::abs(difference)));
  }
  // The draws differ, so that the mean is none of them.
  for (const auto& d : drawn) EXPECT_GT(std::abs(d.posterior.log_density(q) - density.log_density({q.data(), 3})), 1e-3);
}

TEST(NoiseInflation, IsWhatOtherDrawsOfThePosteriorShow) {
  const Fitted f;
  const std::vector<DrawnNoise> wide{f.scaled(9)};
  const DrawnNoiseDensity density(wide);
  const SamplerResult of_wide = short_chains(wide[0].posterior, start_at_mode(wide[0].posterior, f.fit.modes[0]), 2),
                      of_estimate = short_chains(*f.fit.posterior, start_at_mode(*f.fit.posterior, f.fit.modes[0]), 3);
  const NoiseInflation w = noise_inflation(density, *f.fit.posterior, of_wide.coordinates, of_wide.quantities);
  const auto a = assess(of_wide.quantities).parameters, b = assess(of_estimate.quantities).parameters;
  EXPECT_GT(w.plug_in_draws, 300);
  EXPECT_GT(a[1].sd / b[1].sd, 2);
  for (std::size_t k = 0; k < 2; ++k) {
    // Standard errors of either sd, and of the reweighted one.
    const double error = std::hypot(a[k].mcse_sd / a[k].sd, b[k].mcse_sd / b[k].sd, 1 / std::sqrt(2 * w.plug_in_draws));
    EXPECT_NEAR(w.sd_ratio[k], a[k].sd / b[k].sd, 4 * error * w.sd_ratio[k]);
    EXPECT_NEAR(w.sd_ratio[k], w.sd_ratio_alike[k], 1e-9);  // one draw is all there is
  }
  EXPECT_NEAR(w.effective_draws, 1, 1e-9);
}

TEST(NoiseInflation, CountsDrawsByTheRecordsOrAlike) {
  const Fitted f;
  const std::vector<DrawnNoise> same{f.scaled(1), f.scaled(1)}, unlike{f.scaled(1), f.scaled(25)};
  const auto inflation = [&](const std::vector<DrawnNoise>& drawn) {
    const DrawnNoiseDensity density(drawn);
    const SamplerResult r = run_sampler(density, start_at_mode(*f.fit.posterior, f.fit.modes[0]), {.warmup = 2000, .draws = 4000},
                                        {.seed = 4, .journal = {}, .provenance = {}, .progress = {}});
    return noise_inflation(density, *f.fit.posterior, r.coordinates, r.quantities);
  };
  const NoiseInflation none = inflation(same), some = inflation(unlike);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(none.sd_ratio[k], 1, 1e-9);
  EXPECT_NEAR(none.effective_draws, 2, 1e-9);
  // The records reject a noise five times too great; with equal weights it inflates the posterior all the same.
  EXPECT_GT(some.weights[0], 0.99);
  EXPECT_NEAR(some.sd_ratio[0], 1, 0.02);
}

}  // namespace calomel
