#include "forward/surrogate/gaussian_process.hpp"

#include <gtest/gtest.h>

#include "base/random.hpp"
#include "forward/surrogate/matern_kernel.hpp"

using namespace calomel;

namespace {

struct Data {
  Eigen::MatrixXd x;
  Eigen::VectorXd z;
};

Data wavy(Eigen::Index n, double noise) {
  RandomStream random(21, 0);
  Data d{Eigen::MatrixXd(2, n), Eigen::VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    d.x(0, i) = random.uniform();
    d.x(1, i) = random.uniform();
    d.z[i] = std::sin(5 * d.x(0, i)) + 0.3 * d.x(1, i) * d.x(1, i) + noise * random.normal();
  }
  return d;
}

const Eigen::VectorXd kappa0 = Eigen::Vector2d(-1, 0);

}  // namespace

TEST(Warp, DerivativesAgreeWithDifferencesOnBothSidesOfTheSeries) {
  for (const double kappa : {-4.0, -0.5, -5e-5, 0.0, 8e-5, 2e-4, 3.0})
    for (const double x : {0.0, 0.2, 0.9, 1.0}) {
      const double h = 1e-5;
      EXPECT_NEAR(warp(x, kappa).by_x, (warp(x + h, kappa).value - warp(x - h, kappa).value) / (2 * h), 1e-7) << kappa;
      EXPECT_NEAR(warp(x, kappa).by_kappa, (warp(x, kappa + h).value - warp(x, kappa - h).value) / (2 * h), 1e-6) << kappa;
    }
  EXPECT_DOUBLE_EQ(warp(1, 3).value, 1);
  EXPECT_DOUBLE_EQ(warp(0, -3).value, 0);
}

// On u = log(c / c_min) / L, L = log(c_max / c_min), kappa = -L is the parameter itself and kappa = L its inverse.
TEST(Warp, GivesTheParameterAndItsInverseOnALogarithmicFeature) {
  const double low = 500, high = 3000, L = std::log(high / low);
  for (const double c : {500.0, 800.0, 1456.0, 3000.0}) {
    const double u = std::log(c / low) / L;
    EXPECT_NEAR(warp(u, -L).value, (c - low) / (high - low), 1e-13);
    EXPECT_NEAR(warp(u, L).value, (1 / low - 1 / c) / (1 / low - 1 / high), 1e-13);
  }
}

// The kernels are compared with their formula, which takes exp(-r) no smaller than exp(-700) = 1e-304. Features lie between the first and the last point of the
// box, and the warps on both sides of the switch to the series.
TEST(MaternMeans, AgreeWithTheFormulaByEveryInstructionSet) {
  constexpr std::ptrdiff_t points = 3 * matern_padding;
  RandomStream random(6, 0);
  for (const double kappa : {-30.0, -2.0, -2e-4, -9e-5, 0.0, 5e-5, 2e-4, 0.7, 30.0})
    for (const std::ptrdiff_t features : {1, 2, 5})
      for (const std::ptrdiff_t n : {1, 8, 19}) {
        Eigen::MatrixXd at(points, features), x(features, n);
        Eigen::VectorXd weights(points), kappas(features), stretch(features);
        for (auto& v : at.reshaped()) v = 4 * random.uniform();
        for (auto& v : x.reshaped()) v = random.uniform();
        for (auto& v : weights) v = random.normal();
        for (std::ptrdiff_t f = 0; f < features; ++f) kappas[f] = kappa / double(f + 1), stretch[f] = f == 4 ? 2000 : 3 + double(f);
        x.col(0).setZero();
        x.col(n - 1).setOnes();
        at.row(3).setZero();
        Eigen::VectorXd expected = Eigen::VectorXd::Zero(n), scale = expected;
        for (std::ptrdiff_t j = 0; j < n; ++j)
          for (std::ptrdiff_t i = 0; i < points; ++i) {
            double r2 = 0;
            for (std::ptrdiff_t f = 0; f < features; ++f) r2 += std::pow(at(i, f) - stretch[f] * warp(x(f, j), kappas[f]).value, 2);
            const double k = (1 + std::sqrt(r2) + r2 / 3) * std::exp(-std::sqrt(r2));
            expected[j] += weights[i] * k;
            scale[j] += std::abs(weights[i]) * k;
          }
        for (const auto isa : instruction_sets()) {
          Eigen::VectorXd out(n);
          std::vector<double> scratch(std::size_t(points + features * matern_padding));
          matern_means(isa)(
              {.points = points, .features = features, .at = at.data(), .weights = weights.data(), .kappa = kappas.data(), .stretch = stretch.data()}, x.data(),
              n, out.data(), scratch.data());
          for (std::ptrdiff_t j = 0; j < n; ++j)
            EXPECT_NEAR(out[j], expected[j], 1e-9 * scale[j] + 1e-290) << name_of(isa) << ' ' << kappa << ' ' << features << ' ' << j;
        }
      }
}

TEST(GaussianProcess, GradientOfTheMarginalLikelihoodAgreesWithDifferences) {
  const Data d = wavy(25, 0.1);
  Eigen::VectorXd p(5);
  p << -0.5, 0.3, -0.7, 0.4, -4;
  Eigen::VectorXd gradient;
  (void)negative_log_posterior(d.x, d.z, kappa0, p, &gradient);
  for (Eigen::Index i = 0; i < p.size(); ++i) {
    Eigen::VectorXd up = p, down = p;
    up[i] += 1e-5;
    down[i] -= 1e-5;
    const double difference = (negative_log_posterior(d.x, d.z, kappa0, up, nullptr) - negative_log_posterior(d.x, d.z, kappa0, down, nullptr)) / 2e-5;
    EXPECT_NEAR(gradient[i], difference, 1e-6 * gradient.norm()) << i;
  }
}

TEST(GaussianProcess, FitLowersTheObjectiveAndFindsTheIdleFeatureLonger) {
  const Data d = wavy(60, 0.0);
  const GaussianProcessHyperparameters start{Eigen::Vector2d(0, 0), kappa0, -6};
  const auto best = fit_hyperparameters(d.x, d.z, kappa0, start, 100);
  Eigen::VectorXd gradient;
  EXPECT_LT(negative_log_posterior(d.x, d.z, kappa0, best.packed(), &gradient), negative_log_posterior(d.x, d.z, kappa0, start.packed(), nullptr) - 5);
  EXPECT_GT(best.log_length[1], best.log_length[0] + 0.5);
}

TEST(GaussianProcess, InterpolatesAndItsGradientAgreesWithDifferences) {
  const Data d = wavy(60, 0.0);
  const GaussianProcess process(d.x, d.z, {Eigen::Vector2d(-0.5, 0.5), kappa0, -20});
  EXPECT_LT((process.means(d.x) - d.z).cwiseAbs().maxCoeff(), 1e-5);
  const Eigen::Vector2d at(0.37, 0.61);
  const Eigen::VectorXd g = process.gradient(at);
  for (int j = 0; j < 2; ++j) {
    Eigen::Vector2d up = at, down = at;
    up[j] += 1e-5;
    down[j] -= 1e-5;
    EXPECT_NEAR(g[j], (process.means(up)[0] - process.means(down)[0]) / 2e-5, 1e-6 * g.norm());
  }
}

// At 400 new points of noise sd 0.2 the standardised squares have mean 1 with standard error sqrt(2 / 400) = 0.07, beside the
// error of the fitted noise from 80 points (about 0.16). The bounds are 3 standard errors. Control: without the nugget the ratio is far off.
TEST(GaussianProcess, PredictiveVarianceIsCalibratedOnNewNoisyPoints) {
  const Data d = wavy(480, 0.2);
  const Eigen::MatrixXd x = d.x.leftCols(80);
  const Eigen::VectorXd z = d.z.head(80);
  const auto best = fit_hyperparameters(x, z, kappa0, {Eigen::Vector2d(0, 0), kappa0, -3}, 100);
  const GaussianProcess process(x, z, best);
  double sum = 0, without_nugget = 0;
  const double nugget = process.variance_scale() * std::exp(best.log_nugget);
  for (Eigen::Index i = 80; i < 480; ++i) {
    const double error = d.z[i] - process.means(d.x.col(i))[0];
    sum += error * error / process.variance(d.x.col(i));
    without_nugget += error * error / (process.variance(d.x.col(i)) - nugget);
  }
  EXPECT_NEAR(sum / 400, 1, 0.5);
  EXPECT_GT(without_nugget / 400, 3);
}
