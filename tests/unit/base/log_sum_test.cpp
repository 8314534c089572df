#include "base/log_sum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "base/errors.hpp"

using namespace calomel;

namespace {
const double infinity = std::numeric_limits<double>::infinity();
}

TEST(LogSum, IsTheLogarithmOfTheSum) {
  const std::vector<double> logs{std::log(2), std::log(3), std::log(5)};
  EXPECT_NEAR(log_sum(logs), std::log(10), 1e-15);
  EXPECT_NEAR(log_mean(logs), std::log(10.0 / 3), 1e-15);
  EXPECT_NEAR(log_sum(logs, std::vector<double>{0.5, 2, 0}), std::log(7), 1e-15);
  EXPECT_DOUBLE_EQ(log_sum(std::vector<double>{-4.5}), -4.5);
}

TEST(LogSum, NeitherOverflowsNorVanishes) {
  for (const double far : {-1e5, 1e5}) {
    EXPECT_NEAR(log_sum(std::vector<double>{far, far + 1, far - 2000}), far + std::log(1 + std::exp(1)), 1e-10);
    EXPECT_NEAR(log_mean(std::vector<double>{far, far}), far, 1e-10);
  }
  EXPECT_NEAR(log_sum(std::vector<double>{1e5, 0}, std::vector<double>{1e-300, 1}), 1e5 + std::log(1e-300), 1e-9);
}

TEST(LogSum, TakesWhatIsNotThereAsNothing) {
  EXPECT_DOUBLE_EQ(log_sum(std::vector<double>{-infinity, 1.5}), 1.5);
  EXPECT_NEAR(log_mean(std::vector<double>{-infinity, 1.5}), 1.5 - std::log(2), 1e-15);
  EXPECT_EQ(log_sum(std::vector<double>{-infinity, -infinity}), -infinity);
  EXPECT_EQ(log_mean(std::vector<double>{-infinity}), -infinity);
}

TEST(LogSum, RefusesAnEmptySumAndWeightsOfOtherTerms) {
  EXPECT_THROW((void)log_sum(std::vector<double>{}), ContractFailure);
  EXPECT_THROW((void)log_sum(std::vector<double>{1, 2}, std::vector<double>{1}), ContractFailure);
}

TEST(Shares, AreTheTermsOverTheirSum) {
  const auto s = shares(std::vector<double>{1e4 + std::log(1), 1e4 + std::log(3), -infinity});
  ASSERT_EQ(s.size(), 3u);
  EXPECT_NEAR(s[0], 0.25, 1e-11);
  EXPECT_NEAR(s[1], 0.75, 1e-11);
  EXPECT_EQ(s[2], 0);
  const auto weighed = shares(std::vector<double>{-1e4, -1e4}, std::vector<double>{0.2, 0.6});
  EXPECT_DOUBLE_EQ(weighed[0], 0.25);
  EXPECT_DOUBLE_EQ(weighed[1], 0.75);
}
