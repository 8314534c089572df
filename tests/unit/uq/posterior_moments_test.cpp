// Means and deviations of a posterior by draws, beside sums over a grid.
#include "uq/posterior_moments.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/uq/experiment.hpp"
#include "uq/posterior_density.hpp"

namespace calomel {
namespace {

/// Of the one free parameter of a posterior with the multiple beyond the finest mesh beside it: sums over q, as far as the density reaches, and over eight
/// deviations of the multiple.
Moments by_grid(const LogPosterior& posterior, const LocalMode& mode) {
  const PosteriorDensity density(posterior);
  const double sd_beyond = std::sqrt(mode.covariance(1, 1)), top = posterior.log_density(mode.q);
  const auto end = [&](double step) {
    double q = mode.q[0];
    while (density.log_density(std::vector<double>{q, mode.at.beyond}) > top - 30) q += step;
    return q;
  };
  const double low = end(-0.01), high = end(0.01);
  constexpr int n = 200;
  double mass = 0, sum = 0, squares = 0;
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < n; ++k) {
      const std::vector<double> x{low + (i + 0.5) * (high - low) / n, mode.at.beyond + ((k + 0.5) * 16 / n - 8) * sd_beyond};
      std::vector<double> values(2);
      density.constrain(x, values);
      const double p = std::exp(density.log_density(x) - top);
      mass += p;
      sum += p * values[0];
      squares += p * values[0] * values[0];
    }
  }
  const double mean = sum / mass;
  return {Eigen::VectorXd::Constant(1, mean), Eigen::VectorXd::Constant(1, std::sqrt(squares / mass - mean * mean))};
}

}  // namespace

// One parameter is held, where the answer is and where it pushes the other against the edge of its box: there Laplace's deviation is not that of the posterior.
TEST(SampledMoments, AreThoseOfTheDensityAlsoWhereTheBoxCutsIt) {
  const Experiment experiment{0, 0, 0, 1, 1};
  PosteriorInputs in = experiment.base();
  in.discrepancy = false;
  in.run = [](const Eigen::MatrixXd& thetas, const std::vector<int>& level) {
    std::vector<RunRecord> all;
    for (std::size_t i = 0; i < level.size(); ++i) all.push_back(Experiment::run(thetas.col(Eigen::Index(i)), level[i], {}, 1e-8));
    return all;
  };
  const PosteriorFit fit = fit_posterior(in);
  const EmulatorBox& box = fit.posterior->box();
  for (const std::size_t held : {0, 1})
    for (const double u : {fit.modes[0].at.u[Eigen::Index(held)], 0.95, -0.95}) {
      Eigen::VectorXd at = fit.modes[0].at.u;
      at[Eigen::Index(held)] = u;
      const LogPosterior posterior = fit.posterior->held({{held, box.theta(at)[held]}});
      const auto modes = find_modes(posterior, {posterior.q(box.theta(at), 0)});
      ASSERT_FALSE(modes.empty());
      const Moments got = sampled_moments(posterior, modes[0], 1), expected = by_grid(posterior, modes[0]);
      ASSERT_EQ(got.mean.size(), 1);
      const std::string name = std::to_string(held) + '_' + std::to_string(int(100 * u));
      EXPECT_NEAR(got.mean[0], expected.mean[0], 0.2 * expected.sd[0]) << name;  // five standard errors of 800 draws
      EXPECT_NEAR(got.sd[0], expected.sd[0], 0.2 * expected.sd[0]) << name;
    }
}

}  // namespace calomel
