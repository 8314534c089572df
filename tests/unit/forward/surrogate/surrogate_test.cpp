#include "forward/surrogate/surrogate.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "forward/surrogate/input_scaling.hpp"
#include "forward/surrogate/modes.hpp"
#include "forward/surrogate/training.hpp"
#include "tests/scratch.hpp"
#include "wave_family.hpp"

using namespace calomel;

namespace {

/// Options with which every kind trains within a second.
SurrogateOptions quick(const std::string& kind) {
  SurrogateOptions options;
  options.kind = kind;
  options.layers = {24, 16};
  options.epochs = 40;
  options.mode_network.members = 2;
  return options;
}

/// The family with its histories assigned to the wrong runs, so that nothing can be learnt.
Archive shuffled(Archive archive) {
  RandomStream random(9, 9);
  const auto order = random.permutation(archive.runs());
  const Eigen::MatrixXf mean = archive.mean;
  for (std::size_t r = 0; r < order.size(); ++r) archive.mean.col(Eigen::Index(r)) = mean.col(Eigen::Index(order[r]));
  return archive;
}

}  // namespace

class EveryKind : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Kinds, EveryKind, testing::ValuesIn(surrogate_kinds().names()), [](const auto& info) { return info.param; });

TEST(Modes, AreOrthonormalAndRebuildTheHistories) {
  const Archive archive = damped_oscillations(60, 3, 80, 3);
  for (const bool scaled : {false, true}) {
    const ModeBasis basis(archive.mean, 3, {.energy = 0.99999, .per_sensor_scaling = scaled});
    const Eigen::MatrixXd V = basis.vectors().cast<double>();
    EXPECT_LT((V.transpose() * V - Eigen::MatrixXd::Identity(V.cols(), V.cols())).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_GE(basis.energy(), 0.99999);
    EXPECT_LT(basis.modes(), 20);
    const Eigen::MatrixXd z = basis.whitened(archive.mean);
    for (Eigen::Index k = 0; k < z.rows(); ++k) EXPECT_NEAR(z.row(k).squaredNorm() / double(z.cols()), 1, 1e-3) << k;
    const Eigen::MatrixXf back = basis.histories(z, 1);
    EXPECT_GT(fit_metrics(back, archive.mean).r2, 0.9999);
    // The part that the kept modes miss has the size that `variance` reports.
    const double missed = (back - archive.mean).squaredNorm() / double(archive.runs());
    EXPECT_NEAR(basis.variance(Eigen::VectorXd::Zero(basis.modes())).sum() / missed, 1, 0.02);
  }
}

TEST(InputScaling, FeaturesSpanTheBoxAndDerivativesAgreeWithDifferences) {
  const std::vector<Parameter> parameters{bounded("tensile_cutoff", 0, 2), bounded("sound_speed", 100, 900)};
  const InputScaling both(parameters, Coordinates::both, -1, 1);
  ASSERT_EQ(both.features(), 3);
  Eigen::MatrixXd corners(2, 2);
  corners << 0, 2, 100, 900;
  EXPECT_LT((both.features(corners).col(0).array() + 1).abs().maxCoeff(), 1e-14);
  EXPECT_LT((both.features(corners).col(1).array() - 1).abs().maxCoeff(), 1e-14);
  const Eigen::Vector2d at(0.7, 250);
  const Eigen::Vector3d weights(0.3, -2, 5);
  const Eigen::VectorXd g = both.vector_jacobian_product(at, weights);
  for (int j = 0; j < 2; ++j) {
    Eigen::Vector2d up = at, down = at;
    up[j] += 1e-4;
    down[j] -= 1e-4;
    EXPECT_NEAR(g[j], weights.dot(both.features(up).col(0) - both.features(down).col(0)) / 2e-4, 1e-8);
  }
}

TEST_P(EveryKind, SaveAndLoadGiveTheSameBytesOfPrediction) {
  Archive archive = damped_oscillations(30, 3, 50, 3);
  archive.energy_slope = 1.1f * archive.mean;
  archive.scatter = (0.1f * archive.mean).cwiseAbs();
  archive.shape.parameters[0].prior = "normal";
  archive.shape.parameters[0].mean = 1.5;
  archive.shape.parameters[0].sd = 0.1;
  SurrogateSummary summary;
  const auto made = train_surrogate(quick(GetParam()), archive, 4, 2, summary);
  const auto path = scratch_file("surrogate_" + GetParam() + ".nc");
  made->save(path);
  const auto read = load_surrogate(path);
  EXPECT_EQ(read->kind(), GetParam());
  EXPECT_EQ(read->shape().sensors, archive.shape.sensors);
  EXPECT_EQ(read->shape().times, archive.shape.times);
  EXPECT_EQ(read->shape().parameters[0].mean, 1.5);
  EXPECT_EQ(read->shape().parameters[2].nominal, archive.shape.parameters[2].nominal);
  const Eigen::MatrixXd points = spread_points(archive.shape.parameters, 17, 99);
  EXPECT_EQ(made->means(points, 1), read->means(points, 1));
  const std::vector<double> at(points.col(3).begin(), points.col(3).end());
  const Prediction a = made->evaluate(at), b = read->evaluate(at);
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.energy_slope, b.energy_slope);
  EXPECT_EQ(a.scatter, b.scatter);
  EXPECT_EQ(a.energy_slope.size(), archive.shape.values());
  EXPECT_GE(*std::min_element(a.scatter.begin(), a.scatter.end()), 0);
  EXPECT_EQ(made->error_variance(at), read->error_variance(at));
}

TEST_P(EveryKind, IsTheSameOnOneAndTwoThreads) {
  const Archive archive = damped_oscillations(30, 3, 400, 3);
  SurrogateSummary s1, s2;
  const auto one = train_surrogate(quick(GetParam()), archive, 4, 1, s1), two = train_surrogate(quick(GetParam()), archive, 4, 2, s2);
  const Eigen::MatrixXd points = spread_points(archive.shape.parameters, 40, 99);
  EXPECT_EQ(one->means(points, 1), two->means(points, 2));
  EXPECT_EQ(s1.test.rmse, s2.test.rmse);
}

TEST_P(EveryKind, VectorJacobianProductAgreesWithDifferencesOfTheMeans) {
  const Archive archive = damped_oscillations(60, 3, 50, 3);
  SurrogateSummary summary;
  auto options = quick(GetParam());
  options.activation = "tanh";  // a kink of ReLU within the step would not be an error of the gradient
  const auto surrogate = train_surrogate(options, archive, 4, 1, summary);
  ASSERT_TRUE(surrogate->has_gradient());
  RandomStream random(2, 2);
  std::vector<double> weights(archive.shape.values());
  for (double& w : weights) w = random.normal();
  const std::vector<double> at{1.43, 1.2, 0.9};
  const Eigen::VectorXd g = surrogate->vector_jacobian_product(at, weights);
  const auto sum = [&](const std::vector<double>& theta) {
    const auto mean = surrogate->evaluate(theta).mean;
    double s = 0;
    for (std::size_t i = 0; i < mean.size(); ++i) s += weights[i] * mean[i];
    return s;
  };
  for (std::size_t j = 0; j < 3; ++j) {
    auto up = at, down = at;
    // predictions are in single precision
    up[j] += 5e-3;
    down[j] -= 5e-3;
    EXPECT_NEAR(g[Eigen::Index(j)], (sum(up) - sum(down)) / 1e-2, 5e-3 * g.norm()) << j;
  }
}

TEST_P(EveryKind, OutsideTheBoundsIsAFailedRun) {
  const Archive archive = damped_oscillations(20, 2, 30, 3);
  SurrogateSummary summary;
  const auto surrogate = train_surrogate(quick(GetParam()), archive, 4, 1, summary);
  const Prediction p = surrogate->evaluate(std::vector<double>{2.5, 1, 1});
  EXPECT_FALSE(p.ok);
  EXPECT_NE(p.message.find("frequency = 2.5"), std::string::npos);
  Eigen::MatrixXd points(3, 2);
  points << 2.5, 1.5, 1, 1, 1, 1;
  const Eigen::MatrixXf y = surrogate->means(points, 1);
  EXPECT_TRUE(y.col(0).array().isNaN().all());
  EXPECT_TRUE(y.col(1).allFinite());
}

TEST_P(EveryKind, HistoriesAreAnOffsetAndDirectionsTimesCoefficients) {
  const Archive archive = damped_oscillations(25, 2, 40, 3);
  SurrogateSummary summary;
  const auto surrogate = train_surrogate(quick(GetParam()), archive, 4, 1, summary);
  const HistoryBasis basis = surrogate->basis();
  ASSERT_FALSE(basis.empty());
  Eigen::MatrixXd points = archive.theta.leftCols(7);
  points(0, 4) = 2.5;  // outside the bounds
  const Eigen::MatrixXf y = surrogate->means(points, 1), by_basis = (basis.directions * surrogate->coefficients(points)).colwise() + basis.offset;
  for (Eigen::Index i = 0; i < 7; ++i)
    if (i == 4) {
      EXPECT_TRUE(by_basis.col(i).array().isNaN().all());
    } else {
      EXPECT_LT((by_basis.col(i) - y.col(i)).norm(), 1e-5 * y.col(i).norm()) << i;
    }
}

// 30 of 150 runs are held out. The control assigns the histories to the wrong runs, so that nothing can be learnt.
TEST(ModeNetworkSurrogate, LearnsDampedOscillationsAndNothingFromShuffledOnes) {
  SurrogateOptions options;
  options.kind = "mode_network";
  options.mode_network.members = 2;
  options.mode_network.weight_decay = {0.03};
  const Archive archive = damped_oscillations(150, 4, 200, 7);
  SurrogateSummary summary, control;
  (void)train_surrogate(options, archive, 1, 2, summary);
  EXPECT_EQ(summary.n_train, 120);
  EXPECT_EQ(summary.n_test, 30);
  EXPECT_GT(summary.test.r2, 0.999);
  (void)train_surrogate(options, shuffled(archive), 1, 2, control);
  EXPECT_LT(control.test.r2, 0.2);
}

TEST(ModeGaussianProcessSurrogate, LearnsDampedOscillationsAndNothingFromShuffledOnes) {
  SurrogateOptions options;
  options.kind = "mode_gaussian_process";
  const Archive archive = damped_oscillations(100, 4, 200, 7);
  SurrogateSummary summary, control;
  (void)train_surrogate(options, archive, 1, 2, summary);
  EXPECT_GT(summary.test.r2, 0.999);
  (void)train_surrogate(options, shuffled(archive), 1, 2, control);
  EXPECT_LT(control.test.r2, 0.2);
}

TEST(NetworkSurrogate, PublishedFormLearnsDampedOscillations) {
  SurrogateOptions options;
  options.kind = "network";
  SurrogateSummary summary;
  (void)train_surrogate(options, damped_oscillations(150, 4, 50, 7), 1, 2, summary);
  EXPECT_EQ(summary.record.epochs, 100);
  EXPECT_GT(summary.test.r2, 0.8);
}

// Arrival times over 1000 to 2000 m/s make many modes necessary: the processes still carry 99 % of the variance.
TEST(ModeGaussianProcessSurrogate, FollowsMovingArrivals) {
  SurrogateOptions options;
  options.kind = "mode_gaussian_process";
  SurrogateSummary summary;
  (void)train_surrogate(options, mimic_records(150, 6, 200, 8000, 1000, 2000, 7), 1, 2, summary);
  EXPECT_GT(summary.test.r2, 0.99);
}
