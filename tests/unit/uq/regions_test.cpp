// Regions of draws beside those of the Gaussian that they were drawn from.
#include "uq/regions.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/linear_algebra.hpp"
#include "base/random.hpp"

namespace calomel {
namespace {

/// Two correlated quantities whose units lie ten orders of magnitude apart, and a third name.
Draws gaussian(std::size_t n, std::uint64_t seed) {
  Draws d{.names = {"a", "other", "b"}, .chains = 2, .draws = n / 2, .values = {}};
  RandomStream random(seed, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const double x = random.normal(), y = random.normal();
    d.values.insert(d.values.end(), {1e-5 * (3 + x), random.uniform(), 1e5 * (2 + 0.8 * x + 0.6 * y)});
  }
  return d;
}

}  // namespace

TEST(Regions, AreThoseOfTheGaussianThatTheDrawsCameFrom) {
  const std::size_t n = 40000;
  const Draws draws = gaussian(n, 3);
  const Regions r = regions(draws, {"a", "b", "absent"});
  ASSERT_EQ(r.names, (std::vector<std::string>{"a", "b"}));
  ASSERT_EQ(r.shares.size(), 2u);
  EXPECT_NEAR(r.mean[0], 3e-5, 5e-8);
  EXPECT_NEAR(r.covariance(0, 1) / std::sqrt(r.covariance(0, 0) * r.covariance(1, 1)), 0.8, 0.01);
  // Chi-squared of two: -2 ln(1 - share). A quantile's standard error is sqrt(p (1 - p) / n) over the density, 0.01 and 0.03.
  EXPECT_NEAR(r.shares[0].square_radius, -2 * std::log(0.5), 0.05);
  EXPECT_NEAR(r.shares[1].square_radius, -2 * std::log(0.1), 0.15);
  EXPECT_NEAR(r.shares[1].low[1], 1e5 * (2 - 1.645), 3e3);
  EXPECT_NEAR(r.shares[1].high[1], 1e5 * (2 + 1.645), 3e3);
  EXPECT_NEAR(r.shares[0].high[0], 1e-5 * (3 + 0.6745), 2e-7);
  // They hold the share of the draws that they say; without the correlation they would not.
  const Eigen::MatrixXd inverse = calomel::inverse(r.covariance);
  std::size_t inside = 0, without = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d x(draws.values[3 * i] - r.mean[0], draws.values[3 * i + 2] - r.mean[1]);
    inside += x.dot(inverse * x) <= r.shares[1].square_radius;
    without += x[0] * x[0] / r.covariance(0, 0) + x[1] * x[1] / r.covariance(1, 1) <= r.shares[1].square_radius;
  }
  EXPECT_NEAR(double(inside) / double(n), 0.9, 1e-3);
  EXPECT_GT(std::abs(double(without) / double(n) - 0.9), 0.01);
}

// Of one draw nothing can be said but where it is.
TEST(Regions, OfOneDrawThereAreNone) {
  const Regions r = regions({.names = {"a"}, .chains = 1, .draws = 1, .values = {3}}, {"a"});
  EXPECT_EQ(r.mean[0], 3);
  EXPECT_TRUE(r.shares.empty());
}

}  // namespace calomel
