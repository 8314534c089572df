// Kriging, the shift between meshes that is made of it, and the surrogate that added runs set right.
#include "inverse/likelihood/mesh_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/linear_algebra.hpp"
#include "inverse/refined_model.hpp"
#include "tests/unit/inverse/lines.hpp"

namespace calomel {
namespace {

const std::vector<Parameter> square{uniform_parameter("a", 0, 2, 1), uniform_parameter("b", -1, 1, 0)};

/// Points in the box of `square` and an output at each, (4, n): quadratic in a, linear in b, with scatter.
struct Seen {
  Eigen::MatrixXd theta, outputs;
  Seen(int n, double scatter, std::uint64_t seed) : theta(2, n), outputs(4, n) {
    RandomStream random(seed, 0);
    for (int i = 0; i < n; ++i) {
      theta.col(i) << random.uniform(0, 2), random.uniform(-1, 1);
      outputs.col(i) = truth(theta(0, i), theta(1, i));
      for (int k = 0; k < 4; ++k) outputs(k, i) += scatter * random.normal();
    }
  }
  static Eigen::Vector4d truth(double a, double b) {
    return Eigen::Vector4d(5, 2, -1, 0.5) + a * Eigen::Vector4d(0, 1, 1, -2) - 3 * b * Eigen::Vector4d(1, 2, -1, 0.5) + 0.5 * a * a * Eigen::Vector4d(1, 0, 0, 1);
  }
};

/// Outputs about 3 of a Gaussian process of unit variance at n points of the square, with a nugget.
struct Drawn {
  Eigen::MatrixXd theta, outputs;
};
Drawn drawn(RandomStream& random, int n, int outputs, double nugget) {
  Drawn d{Eigen::MatrixXd(2, n), Eigen::MatrixXd(outputs, n)};
  for (int i = 0; i < n; ++i) d.theta.col(i) << random.uniform(0, 2), random.uniform(-1, 1);
  Eigen::MatrixXd r(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) r(i, j) = std::exp(-0.5 * ((d.theta.col(i) - d.theta.col(j)) / 2).squaredNorm() / (0.4 * 0.4)) + (i == j ? nugget : 0.0);
  const Eigen::MatrixXd l = Cholesky(r).lower();
  for (int k = 0; k < outputs; ++k) {
    Eigen::VectorXd e(n);
    for (auto& v : e) v = random.normal();
    d.outputs.row(k) = (l * e).transpose().array() + 3;
  }
  return d;
}

TEST(Kriging, WeightsSumToOneAndReproduceSmoothOutputs) {
  const Seen seen(14, 0, 9);
  const Kriging k(square, seen.theta, seen.outputs);
  const std::vector<double> at{1.1, 0.2};
  EXPECT_NEAR(k.weights(at).sum(), 1, 1e-9);
  EXPECT_LT((seen.outputs * k.weights(at) - Seen::truth(1.1, 0.2)).norm(), 0.02 * Seen::truth(1.1, 0.2).norm());
  EXPECT_LT(k.nugget(), 0.05);
  // At a point that was seen, its own output, and no doubt but the scatter.
  const std::vector<double> first{seen.theta(0, 0), seen.theta(1, 0)};
  EXPECT_LT((seen.outputs * k.weights(first) - seen.outputs.col(0)).norm(), 0.01 * seen.outputs.col(0).norm());
  EXPECT_LT(k.variance_factor(first), 0.01 + 2.5 * k.nugget());
}

TEST(Kriging, WeightsOfManyPointsAreThoseOfEach) {
  const Seen seen(14, 0.1, 9);
  const Kriging k(square, seen.theta, seen.outputs);
  const Eigen::MatrixXd at = Seen(5, 0, 3).theta, w = k.weights_at(at);
  for (Eigen::Index i = 0; i < 5; ++i) EXPECT_LT((w.col(i) - k.weights({at.col(i).data(), 2})).cwiseAbs().maxCoeff(), 1e-10) << i;
}

TEST(Kriging, ScatterIsAveragedAndFarAwayItIsUnsure) {
  Seen seen(16, 0, 3);
  RandomStream random(5, 0);
  for (auto& v : seen.outputs.reshaped()) v = 10 + random.normal();  // nothing but scatter
  const Kriging k(square, seen.theta, seen.outputs);
  const std::vector<double> at{1, 0};
  EXPECT_GT(k.nugget(), 0.3);
  // Four outputs, each about its mean of 10 with at most the sd of a mean of a few.
  EXPECT_LT((seen.outputs * k.weights(at)).array().operator-(10).abs().maxCoeff(), 1.5);
  const Kriging smooth(square, Seen(6, 0, 4).theta * 0.1, Seen(6, 0, 4).outputs);
  const std::vector<double> near{0.1, 0.0}, far{1.9, -0.9};
  EXPECT_GT(smooth.variance_factor(far), 10 * smooth.variance_factor(near));
}

TEST(Kriging, ErrorsOfPredictionsAreWhatItsVarianceSays) {
  // Draws from processes of the very kind: squared errors over their variance average to 1; the same with the variance of the process alone would not.
  double z = 0, blind = 0;
  int count = 0;
  for (int set = 0; set < 60; ++set) {
    RandomStream random(77, std::uint64_t(set));
    const int n = 12, outputs = 5;
    const auto [theta, y] = drawn(random, n + 1, outputs, 0.04);
    const Kriging k(square, theta.leftCols(n), y.leftCols(n));
    const std::vector<double> at{theta(0, n), theta(1, n)};
    const Eigen::VectorXd error = y.col(n) - y.leftCols(n) * k.weights(at);
    const double process = (y.leftCols(n) * k.residual_root()).squaredNorm() / outputs;
    z += error.squaredNorm() / (process * k.variance_factor(at)), blind += error.squaredNorm() / process, count += outputs;
  }
  // 300 values, those of a set share a point and lengths that were fitted: a standard error of about 0.15.
  EXPECT_NEAR(z / count, 1, 0.45);
  EXPECT_LT(blind / count, 0.5);
}

TEST(Kriging, TheSmoothPartIsKnownBetterThanOneMoreOutput) {
  // A process with as much scatter as the pairs of meshes of a box slice show, 0.4 of its variance: the error of the smooth part over its own variance averages
  // to 1; over that of one more output, which the shift between meshes is not, it is far below.
  double smooth = 0, blind = 0;
  int count = 0;
  for (int set = 0; set < 80; ++set) {
    RandomStream random(78, std::uint64_t(set));
    const int n = 12, outputs = 6;
    const auto [theta, y] = drawn(random, n + 1, outputs, 1e-9);
    Eigen::MatrixXd seen = y.leftCols(n);
    for (auto& v : seen.reshaped()) v += std::sqrt(0.4) * random.normal();
    const Kriging k(square, theta.leftCols(n), seen);
    const std::vector<double> at{theta(0, n), theta(1, n)};
    const double process = (seen * k.residual_root()).squaredNorm() / outputs, error = (y.col(n) - seen * k.weights(at)).squaredNorm();
    smooth += error / (process * k.smooth_variance_factor(at)), blind += error / (process * k.variance_factor(at)), count += outputs;
  }
  // 480 values, those of a set share their points: a standard error of about 0.15.
  EXPECT_NEAR(smooth / count, 1, 0.45);
  EXPECT_LT(blind / count, 0.55);
}

TEST(MeshError, ShiftGoesBeyondTheFinerMeshAndItsSpreadKnowsIt) {
  const Seen seen(14, 0, 9);
  const MeshError stays(square, seen.theta, seen.outputs, {.mean = 0, .sd = 0, .remainder = 0}), goes(square, seen.theta, seen.outputs);
  const std::vector<double> at{1.1, 0.2};
  EXPECT_LT((stays.shift(at) - stays.difference(at)).norm(), 1e-12);
  EXPECT_LT((goes.shift(at) - 2 * stays.shift(at)).norm(), 1e-9);
  const auto none = stays.spread(at), some = goes.spread(at);
  EXPECT_LT(none.known.norm(), 0.05 * stays.shift(at).norm());
  EXPECT_EQ(none.remainder.norm(), 0);
  EXPECT_NEAR(some.known.col(some.known.cols() - 1).norm(), 0.5 * stays.difference(at).norm(), 1e-9);
  EXPECT_NEAR(some.remainder.norm(), 0.4 * stays.difference(at).norm(), 1e-9);
  // Two pairs show one direction only: most of their scatter is put down to directions that are not known.
  const auto two = MeshError(square, seen.theta.leftCols(2), seen.outputs.leftCols(2)).spread(at);
  EXPECT_GT(two.scatter.norm(), 2 * two.known.col(0).norm());
}

TEST(MeshError, WhatItsShiftLeavesOfTheWayToTheRecordsIsPartOfItsSpread) {
  // Records at 1 +- 0.5 beyond the finer mesh, an error that is carried to k: (1 - k)^2 + 0.5^2 of the difference's square are left. The shift stays.
  const Seen seen(14, 0, 9);
  const std::vector<double> at{1.1, 0.2};
  for (const auto& [k, left] : {std::pair{0.0, std::sqrt(1.25)}, {0.5, std::sqrt(0.5)}, {1.0, 0.5}, {2.0, std::sqrt(1.25)}}) {
    const MeshError carried(square, seen.theta, seen.outputs, {.mean = k}), judged = carried.with_records_beyond(1, 0.5);
    const auto spread = judged.spread(at);
    EXPECT_NEAR(spread.known.rightCols(1).norm(), left * carried.difference(at).norm(), 1e-9) << k;
    EXPECT_EQ((judged.shift(at) - carried.shift(at)).norm(), 0);
    EXPECT_LT((spread.scatter - carried.spread(at).scatter).norm(), 1e-12);
  }
}

TEST(Kriging, DrawnErrorsHaveTheVarianceOfTheSmoothPartEverywhere) {
  RandomStream random(21, 0);
  const auto [theta, y] = drawn(random, 10, 6, 0.1);
  const Kriging k(square, theta, y);
  const std::vector<double> seen{theta(0, 0), theta(1, 0)}, beside{seen[0] + 0.02, seen[1] - 0.01}, far{0.02, theta(1, 0) > 0 ? -0.98 : 0.98};
  constexpr Eigen::Index fields = 40;
  constexpr int sets = 50;
  double at_seen = 0, at_far = 0, difference = 0, mean = 0;
  for (int set = 0; set < sets; ++set) {
    RandomStream own(22, std::uint64_t(set));
    const KrigingError e(k, fields, own);
    const Eigen::VectorXd a = e.at(seen), b = e.at(beside), c = e.at(far);
    at_seen += a.squaredNorm(), at_far += c.squaredNorm(), difference += (a - b).squaredNorm(), mean += c.sum();
  }
  const double n = double(fields * sets);  // those of a set share their waves: a standard error of 5 to 10 %
  EXPECT_NEAR(at_far / n / k.smooth_variance_factor(far), 1, 0.2);
  EXPECT_NEAR(at_seen / n / k.smooth_variance_factor(seen), 1, 0.2);
  EXPECT_LT(at_seen, 0.5 * at_far);
  EXPECT_LT(difference, 0.1 * at_seen);  // one function of the parameters, not noise
  EXPECT_NEAR(mean / n, 0, 4 * std::sqrt(at_far / n / n));
}

TEST(MeshError, DrawsOfTheKnownScatterAreWhatTheSpreadLeavesToThem) {
  RandomStream random(31, 0);
  const auto [theta, y] = drawn(random, 9, 4, 0.05);
  const MeshError mesh(square, theta, y, {.mean = 0.5, .sd = 0.5});
  const MeshError left = mesh.with_known_scatter_drawn();
  const std::vector<double> at{1.7, 0.8};
  const auto whole = mesh.spread(at), rest = left.spread(at);
  EXPECT_EQ(rest.known.leftCols(8).norm(), 0);
  EXPECT_EQ(rest.known.col(8), whole.known.col(8));
  EXPECT_EQ(rest.scatter, whole.scatter);
  Eigen::Matrix4d seen = Eigen::Matrix4d::Zero();
  constexpr int n = 2000;
  for (int i = 0; i < n; ++i) {
    RandomStream own(32, std::uint64_t(i));
    const Eigen::Vector4d d = left.draw(own).at(at);
    seen += d * d.transpose() / n;
  }
  const Eigen::Matrix4d expected = whole.known.leftCols(8) * whole.known.leftCols(8).transpose();
  EXPECT_LT((seen - expected).norm(), 0.12 * expected.norm());
}

TEST(RefinedModel, IsRightAtTheAddedRunsAndItsVarianceFallsThere) {
  const AnalyticModel truth(square, {[](auto p, double t) { return p[0] * std::sin(3 * t) + p[1] * std::cos(5 * t + p[0]); }}, 40, 0.05);
  const AnalyticModel base(square, {[](auto p, double t) { return 1.1 * p[0] * std::sin(3 * t) + p[1] * std::cos(5 * t + 0.8 * p[0]); }}, 40, 0.05);
  const RefinedModel::Variance variance = [](std::span<const double>) { return Eigen::VectorXd::Constant(40, 1e-4); };
  const Seen seen(10, 0, 21);
  Eigen::MatrixXd y(40, 10);
  for (int i = 0; i < 10; ++i) {
    const auto p = truth.evaluate({seen.theta.col(i).data(), 2});
    y.col(i) = Eigen::Map<const Eigen::VectorXd>(p.mean.data(), 40);
  }
  const RefinedModel refined(base, variance, seen.theta, y);
  EXPECT_GT(refined.base_ratio(), 10);  // the base promised an sd of 0.01
  const auto error = [&](const ForwardModel& m, const std::vector<double>& at) {
    const auto a = m.evaluate(at).mean, b = truth.evaluate(at).mean;
    return (Eigen::Map<const Eigen::VectorXd>(a.data(), 40) - Eigen::Map<const Eigen::VectorXd>(b.data(), 40)).norm();
  };
  const std::vector<double> at{seen.theta(0, 3), seen.theta(1, 3)}, between{1, 0.1};
  EXPECT_LT(error(refined, at), 0.05 * error(base, at));
  EXPECT_LT(error(refined, between), 0.3 * error(base, between));
  EXPECT_LT(refined.error_variance(at).sum(), 0.2 * variance(at).sum() * refined.base_ratio());
  // means and evaluate agree, and the gradient is the derivative.
  const Eigen::MatrixXf m = refined.means(Eigen::Vector2d(between[0], between[1]), 1);
  EXPECT_NEAR(m(7, 0), refined.evaluate(between).mean[7], 1e-5);
  EXPECT_FALSE(refined.has_gradient());
}

}  // namespace
}  // namespace calomel
