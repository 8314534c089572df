#include "forward/emulator/infill.hpp"

#include <gtest/gtest.h>

namespace calomel {
namespace {

MultilevelRegression trained(Eigen::MatrixXd u, int fine) {
  EmulatorRuns runs{.u = std::move(u), .level = {}, .levels = 2};
  for (Eigen::Index i = 0; i < runs.u.cols(); ++i) runs.level.push_back(i < fine ? 0 : 1);
  return {runs, Eigen::MatrixXd::Zero(1, runs.u.cols()), Eigen::VectorXd::Ones(1)};
}

TEST(FirstDesign, BeginsInTheMiddleAndFillsTheBox) {
  const Eigen::MatrixXd u = first_design(3, 65, 2);
  EXPECT_EQ(u.col(0).norm(), 0);
  EXPECT_LE(u.cwiseAbs().maxCoeff(), 1);
  EXPECT_LT(u.rightCols(64).rowwise().mean().norm(), 0.1);
  EXPECT_EQ(u, first_design(3, 65, 2));
  EXPECT_NE(u, first_design(3, 65, 3));
}

TEST(Infill, GoesWhereLeastIsKnownAndNotTwiceToTheSamePlace) {
  Eigen::MatrixXd u = first_design(2, 24, 1);
  u.row(0) = (0.5 * (u.row(0).array() - 1)).matrix();  // no run lies where the first coordinate is above 0
  const auto emulator = trained(u, 8);
  const auto points = infill(emulator, first_design(2, 200, 9), 4, 3);
  ASSERT_EQ(points.level.size(), 7u);
  EXPECT_EQ(std::count(points.level.begin(), points.level.end(), 0), 3);
  EXPECT_GT(points.u(0, 0), 0.7);
  for (Eigen::Index i = 0; i < points.u.cols(); ++i)
    for (Eigen::Index j = 0; j < i; ++j)
      EXPECT_TRUE(points.level[std::size_t(i)] != points.level[std::size_t(j)] || (points.u.col(i) - points.u.col(j)).norm() > 0.1);
}

TEST(Infill, TakesMoreOffTheVarianceThanAsManyRunsAtRandom) {
  const auto emulator = trained(first_design(2, 24, 1), 8);
  const Eigen::MatrixXd draws = first_design(2, 200, 9);
  const auto mean_variance = [&](const MultilevelRegression& e) {
    double sum = 0;
    for (Eigen::Index i = 0; i < draws.cols(); ++i) sum += e.variance(e.features(draws.col(i), 0)) / 200;
    return sum;
  };
  const auto with = [&](const Eigen::MatrixXd& u, const std::vector<int>& level) {
    MultilevelRegression e = emulator;
    for (Eigen::Index i = 0; i < u.cols(); ++i) e = e.with_run(u.col(i), level[std::size_t(i)]);
    return mean_variance(e);
  };
  const auto points = infill(emulator, draws, 4, 4);
  const double chosen = with(points.u, points.level);
  double random = 0;
  for (Eigen::Index first = 0; first < 20; ++first) random += with(draws.middleCols(8 * first, 8), points.level) / 20;
  EXPECT_LT(chosen, 0.8 * random);
  EXPECT_LT(random, mean_variance(emulator));
}

}  // namespace
}  // namespace calomel
