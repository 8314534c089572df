// Tests the regression over meshes on functions that it represents exactly: its variance and leave-one-out errors against refits, its gradient against
// differences.
#include "forward/emulator/multilevel.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/linear_algebra.hpp"
#include "base/random.hpp"
#include "forward/emulator/infill.hpp"

namespace calomel {
namespace {

/// Two outputs over two parameters; the error of the coarse mesh is a linear function.
Eigen::Vector2d smooth(const Eigen::VectorXd& u, int level) {
  Eigen::Vector2d z(1 + 2 * u[0] - u[1] + 0.5 * u[0] * u[1], 3 - u[0] + 0.7 * u[1] * u[1]);
  if (level == 1) z += Eigen::Vector2d(0.3 + 0.2 * u[0], -0.1 * u[1]);
  return z;
}

struct Design {
  EmulatorRuns runs;
  Eigen::MatrixXd outputs;
};

/// `coarse` and `fine` runs with numerical noise of sd `noise`, and of twice that on the coarse mesh.
Design design(int coarse, int fine, double noise, std::uint64_t seed = 1) {
  RandomStream random(seed, 0);
  const Eigen::MatrixXd u = first_design(2, coarse, 5);
  Design d{{Eigen::MatrixXd(2, coarse + fine), {}, 2}, Eigen::MatrixXd(2, coarse + fine)};
  for (int i = 0; i < coarse + fine; ++i) {
    const int level = i < coarse ? 1 : 0;
    d.runs.u.col(i) = u.col(i % coarse);
    d.runs.level.push_back(level);
    d.outputs.col(i) = smooth(d.runs.u.col(i), level);
    for (auto& y : d.outputs.col(i)) y += noise * (1 + level) * random.normal();
  }
  return d;
}

const Eigen::VectorXd equal = Eigen::Vector2d::Ones();

TEST(EmulatorBox, CoordinatesGoThereAndBack) {
  const EmulatorBox box({{.name = "rho", .min = 10, .max = 1000}, {.name = "s", .min = 0, .max = 9}}, std::vector<double>{100, 2}, std::vector<double>{400, 6});
  const Eigen::VectorXd middle = box.u(std::vector<double>{200, 4});
  EXPECT_NEAR(middle.norm(), 0, 1e-12);  // 200 is the middle of the logarithms
  const auto theta = box.theta(Eigen::Vector2d(0.3, -0.8));
  EXPECT_NEAR(box.u(theta)[0], 0.3, 1e-12);
  EXPECT_NEAR(box.u(theta)[1], -0.8, 1e-12);
  const Eigen::VectorXd slope = box.derivative(Eigen::Vector2d(0.3, -0.8));
  EXPECT_NEAR(slope[0], (box.theta(Eigen::Vector2d(0.3 + 1e-6, -0.8))[0] - theta[0]) / 1e-6, 1e-3);
  EXPECT_NEAR(slope[1], 2, 1e-12);
  EXPECT_TRUE(box.contains(std::vector<double>{400, 2}));
  EXPECT_FALSE(box.contains(std::vector<double>{401, 2}));
  EXPECT_NEAR(box.nearest(std::vector<double>{1000, 4})[0], 400, 1e-9);
}

TEST(MultilevelRegression, HoldsWhatItCanHoldExactlyOnEveryMeshAndBeyond) {
  const Design d = design(20, 6, 0);
  const MultilevelRegression e(d.runs, d.outputs, equal);
  const Eigen::MatrixXd c = e.fit(d.outputs);
  const Eigen::Vector2d u(0.37, -0.61), fine = smooth(u, 0), coarse = smooth(u, 1);
  EXPECT_LT((c * e.features(u, 0) - fine).norm(), 1e-6);
  EXPECT_LT((c * e.features(u, -1) - coarse).norm(), 1e-6);
  EXPECT_LT((c * e.features(u, 0.25) - (fine + 0.25 * (fine - coarse))).norm(), 1e-6);
  EXPECT_LT((d.outputs * e.weights(e.features(u, 0)) - fine).norm(), 1e-6);
}

TEST(MultilevelRegression, DerivativesAreThoseOfTheFeatures) {
  const Design d = design(20, 6, 0.1);
  const MultilevelRegression e(d.runs, d.outputs, equal);
  const Eigen::Vector2d u(0.2, 0.5);
  const double k = 0.4, h = 1e-6;
  const Eigen::MatrixXd s = e.features_slope(u, k);
  for (int i = 0; i < 2; ++i) {
    Eigen::Vector2d up = u, down = u;
    up[i] += h;
    down[i] -= h;
    EXPECT_LT((s.col(i) - (e.features(up, k) - e.features(down, k)) / (2 * h)).norm(), 1e-8);
  }
  EXPECT_LT((s.col(2) - (e.features(u, k + h) - e.features(u, k - h)) / (2 * h)).norm(), 1e-8);
}

TEST(MultilevelRegression, LeftOutErrorsAreThoseOfARefitWithoutTheRun) {
  const Design d = design(20, 7, 0.1);
  const MultilevelRegression e(d.runs, d.outputs, equal);
  const Eigen::MatrixXd left_out = e.left_out(d.outputs);
  for (const Eigen::Index i : {3, 22}) {
    // The refit has the weights of the whole fit: ordinary least squares with the estimated noise ratios.
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(9, 9), right = Eigen::MatrixXd::Zero(9, 2);
    for (Eigen::Index j = 0; j < d.outputs.cols(); ++j) {
      if (j == i) continue;
      const Eigen::VectorXd x = e.level_features(d.runs.u.col(j), d.runs.level[std::size_t(j)]);
      const double w = 1 / e.noise_ratio()[std::size_t(d.runs.level[std::size_t(j)])];
      normal += w * x * x.transpose();
      right += w * x * d.outputs.col(j).transpose();
    }
    const Eigen::MatrixXd c = inverse(normal) * right;
    const Eigen::VectorXd error = d.outputs.col(i) - c.transpose() * e.level_features(d.runs.u.col(i), d.runs.level[std::size_t(i)]);
    EXPECT_LT((left_out.col(i) - error).norm(), 1e-5 * (1 + error.norm()));
  }
}

TEST(MultilevelRegression, FindsThatACoarseMeshIsNoisierAndItsVarianceIsThatOfRepeatedDesigns) {
  const Eigen::Vector2d u(0.5, 0.4);
  double ratio = 0, squares = 0, variance = 0, noise = 0;
  constexpr int repeats = 200;
  for (int r = 0; r < repeats; ++r) {
    const Design d = design(40, 14, 0.1, 100 + std::uint64_t(r));
    const MultilevelRegression e(d.runs, d.outputs, equal);
    ratio += e.noise_ratio()[1] / repeats;
    variance += e.variance(e.features(u, 0)) / repeats;
    squares += (e.fit(d.outputs) * e.features(u, 0) - smooth(u, 0)).squaredNorm() / 2 / repeats;
    noise += e.residuals(d.outputs).squaredNorm() / 2 / e.freedom() / repeats;
  }
  EXPECT_NEAR(ratio, 4, 1.2);  // ratios of variances; the finest mesh has few squares and is shrunk towards the pooled ratio
  EXPECT_NEAR(noise, 0.01, 0.0015);
  EXPECT_NEAR(squares / (0.01 * variance), 1, 0.35);  // 200 repeats of two outputs have the standard error 0.07; the rest is the error of the ratio
}

TEST(MultilevelRegression, WithAnotherNoiseRatioIsLeastSquaresWithItsWeights) {
  const Design d = design(20, 7, 0.1);
  const MultilevelRegression e(d.runs, d.outputs, equal);
  const MultilevelRegression same = e.with_noise_ratio(e.noise_ratio()), other = e.with_noise_ratio({1, 0.3});
  EXPECT_LT((same.fit(d.outputs) - e.fit(d.outputs)).norm(), 1e-4 * e.fit(d.outputs).norm());  // the estimate of the ratio is exact to 1e-6
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(9, 9), right = Eigen::MatrixXd::Zero(9, 2);
  for (Eigen::Index j = 0; j < d.outputs.cols(); ++j) {
    const Eigen::VectorXd x = e.level_features(d.runs.u.col(j), d.runs.level[std::size_t(j)]);
    const double w = d.runs.level[std::size_t(j)] == 0 ? 1 : 1 / 0.3;
    normal += w * x * x.transpose();
    right += w * x * d.outputs.col(j).transpose();
  }
  EXPECT_LT((other.fit(d.outputs).transpose() - inverse(normal) * right).norm(), 1e-8);
  EXPECT_LT((other.inverse() - inverse(normal)).norm(), 1e-8 * other.inverse().norm());
  EXPECT_GT((other.fit(d.outputs) - e.fit(d.outputs)).norm(), 1e-4);
  EXPECT_NEAR(other.leverage().sum(), 9, 1e-6);  // coefficients
}

TEST(MultilevelRegression, NoiseOfALevelIsItsSquaresOverWhatIsLeftAndLeansOnAll) {
  const Design d = design(20, 7, 0.1);
  const MultilevelRegression e(d.runs, d.outputs, equal);
  Eigen::VectorXd squares = Eigen::VectorXd::Constant(27, 4), left = Eigen::VectorXd::Constant(27, 0.5);
  squares.tail(7).setConstant(1);
  left.tail(7).setConstant(0.25);
  const double all = (80.0 + 7) / (10 + 1.75);
  const auto noise = e.level_noise(squares, left);
  EXPECT_NEAR(noise[0], (7 + 0.25 * all) / (1.75 + 0.25), 1e-12);
  EXPECT_NEAR(noise[1], (80 + 0.25 * all) / (10 + 0.25), 1e-12);
}

TEST(MultilevelRegression, VarianceGrowsOutsideTheDesignAndFallsWithOneMoreRun) {
  const Design d = design(20, 6, 0.1);
  const MultilevelRegression e(d.runs, d.outputs, equal);
  const Eigen::Vector2d corner(1, 1);
  EXPECT_GT(e.variance(e.features(2 * corner, 0)), 4 * e.variance(e.features(corner, 0)));
  const auto more = e.with_run(corner, 0);
  EXPECT_LT(more.variance(more.features(corner, 0)), e.variance(e.features(corner, 0)));
  // The result equals a refit with that run, whatever the run's values are.
  Design larger = d;
  larger.runs.u.conservativeResize(Eigen::NoChange, 27);
  larger.runs.u.col(26) = corner;
  larger.runs.level.push_back(0);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(9, 9);
  for (Eigen::Index j = 0; j < 27; ++j) {
    const Eigen::VectorXd x = e.level_features(larger.runs.u.col(j), larger.runs.level[std::size_t(j)]);
    normal += x * x.transpose() / e.noise_ratio()[std::size_t(larger.runs.level[std::size_t(j)])];
  }
  EXPECT_NEAR(more.variance(more.features(corner, 0)), more.features(corner, 0).dot(inverse(normal) * more.features(corner, 0)), 1e-6);
}

TEST(MultilevelRegression, RefusesFewerRunsThanCoefficients) {
  const Design d = design(5, 3, 0.1);
  EXPECT_THROW(MultilevelRegression(d.runs, d.outputs, equal), ContractFailure);
}

}  // namespace
}  // namespace calomel
