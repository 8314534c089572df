#include "uq/sampler/dram.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/unit/uq/sampler/densities.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

namespace {}

TEST(DelayedAcceptance, OneStageIsMetropolis) {
  const Eigen::MatrixXd z = Eigen::MatrixXd::Random(3, 2);
  EXPECT_DOUBLE_EQ(log_delayed_acceptance(std::vector{-1.0, -3.0}, z, 0.2), -2);
  EXPECT_DOUBLE_EQ(log_delayed_acceptance(std::vector{-3.0, -1.0}, z, 0.2), 0);
  EXPECT_EQ(log_delayed_acceptance(std::vector{-3.0, never}, z, 0.2), never);
}

// Written out by hand for d = 1: a2 = p(y2) q(y2, y1) (1 - a1(y2, y1)) / (p(x) q(x, y1) (1 - a1(x, y1))).
TEST(DelayedAcceptance, SecondStageIsTheFormulaOfMira) {
  const double lx = -1, l1 = -4, l2 = -2;
  Eigen::MatrixXd z(1, 3);
  z << 0, 1.7, 0.3;
  const double q = std::exp(-0.5 * (1.4 * 1.4 - 1.7 * 1.7));
  const double a = std::exp(l2 - lx) * q * (1 - std::exp(l1 - l2)) / (1 - std::exp(l1 - lx));
  EXPECT_NEAR(std::exp(log_delayed_acceptance(std::vector{lx, l1, l2}, z, 0.2)), a, 1e-14);
  // What the first stage would have accepted from the other side can not be refused there.
  EXPECT_EQ(log_delayed_acceptance(std::vector{-1.0, -2.5, -3.0}, z, 0.2), never);
  // A first try outside of the support counts as refused on both sides.
  EXPECT_NEAR(log_delayed_acceptance(std::vector{lx, never, l2}, z, 0.2), -1 - 0.5 * (1.4 * 1.4 - 1.7 * 1.7), 1e-14);
}

// Detailed balance of a whole path: p(x) q1 .. qi (1 - a1) .. (1 - a(i-1)) ai is the same forwards and backwards.
TEST(DelayedAcceptance, PathsAreInDetailedBalanceAtEveryStage) {
  for (int stages = 2; stages <= 4; ++stages)
    for (unsigned trial = 0; trial < 200; ++trial) {
      std::srand(trial);
      const Eigen::MatrixXd z = Eigen::MatrixXd::Random(2, stages + 1);
      const Eigen::VectorXd l = 2 * Eigen::VectorXd::Random(stages + 1);
      const double shrink = 0.5;
      const auto flow = [&](const Eigen::MatrixXd& points, const Eigen::VectorXd& values) {
        double sum = values[0];
        for (int j = 1; j <= stages; ++j) {
          sum += -0.5 * (points.col(j) - points.col(0)).squaredNorm() / std::pow(shrink, 2 * (j - 1));
          const double a = log_delayed_acceptance({values.data(), std::size_t(j + 1)}, points.leftCols(j + 1), shrink);
          sum += j < stages ? std::log1p(-std::exp(a)) : a;
        }
        return std::exp(sum);
      };
      EXPECT_NEAR(flow(z, l), flow(z.rowwise().reverse(), l.reverse()), 1e-12);
    }
}

TEST(Dram, CovarianceThatIsNotPositiveDefiniteIsTheUsersMistake) {
  const Gaussian density(Eigen::VectorXd::Zero(2), Eigen::MatrixXd::Identity(2, 2));
  Eigen::MatrixXd c(2, 2);
  c << 1, 2, 2, 1;
  EXPECT_THROW((void)dram_chain(density, {}, c), InputError);
}

TEST(Dram, NaNIsADefectOfTheDensityAndNamesThePlace) {
  const Written density(2, [](std::span<const double> x) { return x[0] > 0.5 ? std::nan("") : 0.0; });
  const auto chain = dram_chain(density, {}, Eigen::MatrixXd::Identity(2, 2));
  chain->begin(std::vector{0.0, 0.0}, 0);
  RandomStream random(1, 0);
  try {
    for (int i = 0; i < 1000; ++i) (void)chain->step(random, false);
    FAIL();
  } catch (const NumericsError& e) {
    EXPECT_THAT(e.what(), HasSubstr("x1 = "));
    EXPECT_THAT(e.what(), HasSubstr("NaN"));
  }
}

TEST(Dram, FrozenChainLearnsNoMore) {
  const Gaussian density(Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Identity(1, 1));
  const auto chain = dram_chain(density, {}, Eigen::MatrixXd::Identity(1, 1));
  chain->begin(std::vector{0.0}, 0);
  chain->freeze();
  RandomStream random(1, 0);
  EXPECT_THROW((void)chain->step(random, true), ContractFailure);
}

TEST(Dram, WarmUpFindsTheShapeFromACovarianceThatIsMillionsOff) {
  Eigen::MatrixXd c(2, 2);  // correlation 0.999, deviations 1e-3 and 1
  c << 1e-6, 0.999e-3, 0.999e-3, 1;
  const Gaussian density(Eigen::VectorXd::Zero(2), c);
  const auto chain = dram_chain(density, {}, Eigen::MatrixXd::Identity(2, 2));
  chain->begin(std::vector{0.0, 0.0}, 0);
  RandomStream random(1, 0);
  for (int i = 0; i < 5000; ++i) (void)chain->step(random, true);
  chain->freeze();
  double acceptance = 0, product = 0, last = 0;
  for (int i = 0; i < 5000; ++i) {
    acceptance += chain->step(random, false).acceptance / 5000;
    if (i > 0) product += chain->position(0)[1] * last / 4999;
    last = chain->position(0)[1];
  }
  EXPECT_GT(acceptance, 0.3);
  EXPECT_LT(product, 0.97);  // of neighbours, about 0.8; 0.9999 with steps as long as the narrow direction alone
}
