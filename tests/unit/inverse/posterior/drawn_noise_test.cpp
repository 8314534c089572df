// Tests draws of the numerical noise's hyperparameters: whether they scatter as the estimates do, and whether their mean is the estimate.
#include "inverse/posterior/drawn_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.hpp"
#include "forward/emulator/infill.hpp"
#include "tests/unit/inverse/lines.hpp"

namespace calomel {
namespace {

constexpr double noise_sd = 0.05;

/// Two sensors that are linear in two parameters, with runs whose noise is three times as large on the coarse mesh.
struct Noisy {
  std::vector<Parameter> parameters{normal_parameter("a", 2, 0.5), normal_parameter("b", 0.5, 0.5)};
  AnalyticModel model{
      parameters, {[](auto p, double t) { return p[0] * (1 + t / 3e-5); }, [](auto p, double t) { return p[1] * std::cos(4e4 * t) - p[0]; }}, 60, 1e-6};
  Recordings recordings = pulses_of(model, {2.2, 0.7}, {.pulses = 8, .noise = 0.1}, 3);
  RecordingOptions recording_options;
  Problem problem = make_problem(model.shape(), recordings, recording_options);
  double noise = noise_sd;

  [[nodiscard]] PosteriorInputs inputs() const {
    PosteriorInputs in{.problem = problem, .recordings = recordings, .recording_options = recording_options};
    in.errors = {.values = 40, .band = 1e6, .energy_scale_sd = 0, .gain_sd = 0, .beyond_sd = 0, .beyond_rest = 0};
    in.emulator.coarse_runs = 24;
    in.emulator.fine_runs = 12;
    in.emulator.round_coarse = in.emulator.round_fine = 2;
    in.parameters = parameters;
    in.levels = 2;
    in.centre = {2.2, 0.7};
    in.half_width = {0.6, 0.6};
    in.run = [this](const Eigen::MatrixXd& thetas, const std::vector<int>& level) {
      std::vector<RunRecord> all;
      for (std::size_t i = 0; i < level.size(); ++i) {
        const Eigen::VectorXd theta = thetas.col(Eigen::Index(i));
        std::uint64_t hash = 7 + std::uint64_t(level[i]);
        for (const double v : theta) hash = hash * 1099511628211ull + std::uint64_t(std::llround(1e9 * std::abs(v)));
        RandomStream random(hash, 0);
        RunRecord r{.done = true};
        for (const double y : model.evaluate({theta.data(), 2}).mean) r.mean.push_back(float(y + noise * (level[i] > 0 ? 3 : 1) * random.normal()));
        all.push_back(std::move(r));
      }
      return all;
    };
    return in;
  }
};

}  // namespace

TEST(BootstrapWeights, AreThoseOfADirichletAndComeFromSeedAndDrawAlone) {
  const Eigen::VectorXd left = Eigen::Vector4d(0.9, 0.5, 0.05, 0.75);
  const double nu = left.sum();
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(4), square = mean;
  constexpr int n = 20000;
  for (int b = 0; b < n; ++b) {
    const Eigen::VectorXd a = bootstrap_weights(left, 1, std::uint64_t(b));
    EXPECT_NEAR(a.sum(), nu, 1e-12);
    mean += a / n;
    square += a.cwiseAbs2() / n;
  }
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double variance = left[i] * (nu - left[i]) / (nu + 1);
    EXPECT_NEAR(mean[i], left[i], 4 * std::sqrt(variance / n)) << i;
    EXPECT_NEAR(square[i] - mean[i] * mean[i], variance, 0.05 * variance + 1e-3) << i;
  }
  EXPECT_EQ(bootstrap_weights(left, 1, 3), bootstrap_weights(left, 1, 3));
  EXPECT_NE(bootstrap_weights(left, 1, 3), bootstrap_weights(left, 1, 4));
  EXPECT_NE(bootstrap_weights(left, 1, 3), bootstrap_weights(left, 2, 3));
}

// 36 runs and 21 coefficients leave 15 squares. The scatter of a drawn variance is compared with that of the estimate over many sets of runs.
TEST(BootstrapWeights, HaveTheVarianceOfTheEstimateAlsoWithManyCoefficients) {
  constexpr Eigen::Index runs = 36;
  const Eigen::MatrixXd u = first_design(5, int(runs), 2);
  const EmulatorRuns design{.u = u, .level = std::vector<int>(std::size_t(runs), 0), .levels = 1};
  RandomStream random(9, 0);
  const auto noise = [&] {
    Eigen::MatrixXd e(1, runs);
    for (double& x : e.reshaped()) x = random.normal();
    return e;
  };
  const MultilevelRegression regression(design, noise(), Eigen::VectorXd::Ones(1));
  const Eigen::VectorXd left = (1 - regression.leverage().array()).matrix();
  EXPECT_NEAR(left.sum(), 15, 1e-6);
  constexpr int sets = 1000, draws = 60;
  double mean = 0, square = 0, drawn_mean = 0, own = 0, plain = 0, shrunk = 0;
  for (int s = 0; s < sets; ++s) {
    const Eigen::MatrixXd rest = regression.residuals(noise());
    const Eigen::VectorXd squares = rest.row(0).cwiseAbs2().transpose();
    const double estimate = squares.sum() / left.sum();
    mean += estimate / sets;
    square += estimate * estimate / sets;
    const auto add_variance = [&](const Eigen::VectorXd& weights_of, const Eigen::VectorXd& per_weight, double& total) {
      double m = 0, q = 0;
      for (int b = 0; b < draws; ++b) {
        const double v = bootstrap_weights(weights_of, std::uint64_t(s), std::uint64_t(b)).dot(per_weight);
        m += v / draws;
        q += v * v / draws;
      }
      total += (q - m * m) * draws / (draws - 1) / sets;
      return m;
    };
    drawn_mean += add_variance(left, squares.cwiseQuotient(left) / left.sum(), own) / sets;
    (void)add_variance(Eigen::VectorXd::Ones(runs), squares / left.sum(), plain);     // control: Rubin's weights, without the correction for the coefficients
    (void)add_variance(Eigen::VectorXd::Ones(runs), squares / double(runs), shrunk);  // control: uncorrected residuals
  }
  const double variance = square - mean * mean;  // 2 / 15 of sigma^4; known to 4 %
  EXPECT_NEAR(mean, 1, 0.05);
  EXPECT_NEAR(drawn_mean, mean, 0.01);
  EXPECT_NEAR(variance, 2.0 / 15, 0.025);
  EXPECT_NEAR(std::sqrt(own / variance), 0.95, 0.05);  // 15 squares are few: the x_i of a bootstrap are as few
  EXPECT_LT(std::sqrt(plain / variance), 0.8);         // controls
  EXPECT_LT(std::sqrt(shrunk / variance), 0.5);
}

TEST(DrawNoise, LiesAboutTheEstimateAndIsTheSameOnAnyThreads) {
  const Noisy noisy;
  const PosteriorInputs in = noisy.inputs();
  const PosteriorFit fit = fit_posterior(in);
  constexpr int n = 200;
  const auto drawn = draw_noise(in, fit, n, 3, 2);
  ASSERT_EQ(drawn.size(), std::size_t(n));
  double scale = 0, square = 0, log_ratio = 0, ratio_square = 0;
  for (const auto& d : drawn) {
    EXPECT_DOUBLE_EQ(d.noise_ratio[0], 1);
    scale += d.scale / n;
    square += d.scale * d.scale / n;
    log_ratio += std::log(d.noise_ratio[1]) / n;
    ratio_square += std::pow(std::log(d.noise_ratio[1]), 2) / n;
  }
  const double sd = std::sqrt(square - scale * scale);
  const double ratio_sd = std::sqrt(ratio_square - log_ratio * log_ratio);
  const double truth = std::log(9.0);
  EXPECT_NEAR(scale, 1, 0.1);
  EXPECT_GT(sd, 0.02);
  EXPECT_LT(sd, 0.5);
  // The true ratio of the noise variances of the meshes is 9.
  EXPECT_LT(std::abs(log_ratio - truth), 4 * ratio_sd);
  EXPECT_GT(ratio_sd, 0.02);
  const auto again = draw_noise(in, fit, 3, 3, 1), other = draw_noise(in, fit, 1, 4, 1);
  for (std::size_t b = 0; b < 3; ++b) EXPECT_EQ(again[b].scale, drawn[b].scale);
  EXPECT_NE(other[0].scale, drawn[0].scale);
}

TEST(DrawNoise, EachDrawHasItsNoiseInTheRecordsErrorsAndInTheEmulators) {
  const Noisy noisy;
  const PosteriorInputs in = noisy.inputs();
  const PosteriorFit fit = fit_posterior(in);
  const auto drawn = draw_noise(in, fit, 3, 3, 1);
  const auto& at = fit.modes[0].at;
  for (const auto& d : drawn) {
    const MultilevelRegression expected = fit.posterior->emulator().with_noise_ratio(d.noise_ratio);
    const Eigen::VectorXd x = expected.features(at.u, at.beyond);
    EXPECT_NEAR(d.posterior.density(at).variance, expected.variance(x), 1e-12);
    EXPECT_NE(d.posterior.density(at).log_likelihood, fit.posterior->density(at).log_likelihood);
    EXPECT_EQ(d.posterior.density(at).log_prior, fit.posterior->density(at).log_prior);
  }
  PosteriorInputs without = in;
  without.errors.record_noise = 0;
  const PosteriorFit bare = fit_posterior(without);
  for (const auto& d : draw_noise(without, bare, 2, 3, 1)) EXPECT_TRUE(std::isfinite(d.posterior.density(bare.modes[0].at).log_likelihood));
}

}  // namespace calomel
