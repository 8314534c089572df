#include "forward/campaign/design.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.hpp"
#include "forward/campaign/archive.hpp"
#include "forward/campaign/campaign.hpp"

using namespace calomel;

namespace {

Eigen::MatrixXd independent_points(std::size_t dimensions, std::size_t runs, std::uint64_t seed) {
  RandomStream stream(seed, 0);
  Eigen::MatrixXd points(dimensions, runs);
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    for (Eigen::Index d = 0; d < points.rows(); ++d) points(d, i) = stream.uniform();
  return points;
}

/// Largest number of points of a coordinate in one of `cells` equal intervals.
int fullest_cell(const Eigen::RowVectorXd& x, int cells) {
  std::vector<int> count(std::size_t(cells), 0);
  for (const double v : x) ++count[std::size_t(v * cells)];
  return *std::max_element(count.begin(), count.end());
}

/// Kolmogorov's statistic sqrt(n) sup |F_n - F|.
template <class Cdf>
double kolmogorov(const Eigen::RowVectorXd& x, Cdf cdf) {
  std::vector<double> sorted(x.begin(), x.end());
  std::sort(sorted.begin(), sorted.end());
  double d = 0;
  const double n = double(sorted.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) d = std::max({d, cdf(sorted[i]) - double(i) / n, double(i + 1) / n - cdf(sorted[i])});
  return std::sqrt(n) * d;
}

double arcsine_cdf(double x) { return 2 / std::numbers::pi * std::asin(std::sqrt(x)); }
double uniform_cdf(double x) { return x; }

/// Squared L2 star discrepancy (Warnock 1972).
double l2_star_discrepancy_squared(const Eigen::MatrixXd& x) {
  const double n = double(x.cols()), s = double(x.rows());
  double single = 0, pairs = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    single += (1 - x.col(i).array().square()).prod();
    for (Eigen::Index j = 0; j < x.cols(); ++j) pairs += (1 - x.col(i).cwiseMax(x.col(j)).array()).prod();
  }
  return std::pow(3, -s) - std::pow(2, 1 - s) / n * single + pairs / (n * n);
}

}  // namespace

TEST(Design, EveryCatalogueEntryFillsTheUnitCubeAndFollowsItsSeed) {
  for (const auto& row : designs().rows()) {
    const auto points = row.entry.points(5, 100, 1);
    ASSERT_EQ(points.rows(), 5) << row.name;
    ASSERT_EQ(points.cols(), 100) << row.name;
    EXPECT_GE(points.minCoeff(), 0) << row.name;
    EXPECT_LE(points.maxCoeff(), 1) << row.name;
    EXPECT_EQ(points, row.entry.points(5, 100, 1)) << row.name;
    EXPECT_GT((points - row.entry.points(5, 100, 2)).cwiseAbs().maxCoeff(), 0.1) << row.name;
  }
}

TEST(Design, AnUnknownNameIsRefusedWithTheKnownOnes) {
  const std::vector<Parameter> one{{.name = "a", .min = 0, .max = 1}};
  try {
    (void)design_points("sobl", one, 10, 1);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::AllOf(testing::HasSubstr("campaign.design"), testing::HasSubstr("did you mean \"sobol\"")));
  }
}

TEST(Design, SobolHasOnePointInEachDyadicIntervalUnderEverySeed) {
  for (const std::uint64_t seed : {1u, 2u, 77u}) {
    const auto points = sobol_points(40, 256, seed);
    for (Eigen::Index d = 0; d < points.rows(); ++d) EXPECT_EQ(fullest_cell(points.row(d), 256), 1) << d;
  }
  const auto independent = independent_points(40, 256, 1);  // negative control
  EXPECT_GT(fullest_cell(independent.row(0), 256), 2);
}

TEST(Design, SobolPairsFillTheSquaresOfTheFirstTwoCoordinates) {  // a (0, m, 2)-net: one point in each 16 x 16 box of 256
  const auto points = sobol_points(2, 256, 3);
  std::vector<int> count(256, 0);
  for (Eigen::Index i = 0; i < 256; ++i) ++count[std::size_t(points(0, i) * 16) * 16 + std::size_t(points(1, i) * 16)];
  EXPECT_THAT(count, testing::Each(1));
}

TEST(Design, SobolIsFarMoreEvenThanIndependentPoints) {
  const int n = 256, s = 5;
  const double sobol = l2_star_discrepancy_squared(sobol_points(s, n, 1));
  // The mean over independent points is exactly (2^-s - 3^-s) / n (Warnock 1972).
  const double expected = (std::pow(2, -s) - std::pow(3, -s)) / n;
  EXPECT_LT(sobol, 0.2 * expected);
  double independent = 0;  // negative control: the mean of 40 has a standard error near expected / sqrt(40) = 0.16 expected
  for (int r = 0; r < 40; ++r) independent += l2_star_discrepancy_squared(independent_points(s, n, 100 + r)) / 40;
  EXPECT_NEAR(independent / expected, 1, 0.5);
}

TEST(Design, SobolStopsAtFortyParameters) { EXPECT_THROW((void)sobol_points(41, 10, 1), InputError); }

TEST(Design, LatinHypercubeHasOnePointInEachSliceOfEveryCoordinate) {
  const auto points = latin_hypercube_points(50, 97, 1);
  for (Eigen::Index d = 0; d < points.rows(); ++d) EXPECT_EQ(fullest_cell(points.row(d), 97), 1);
  // Independent coordinates: the correlation of two has the standard error 1 / sqrt(96) = 0.10.
  const Eigen::RowVectorXd a = points.row(0).array() - points.row(0).mean(), b = points.row(1).array() - points.row(1).mean();
  EXPECT_LT(std::abs(a.dot(b)) / (a.norm() * b.norm()), 0.4);
}

TEST(Design, ChebyshevFollowsTheArcsineLaw) {
  // Independent draws would exceed 1.63 once in a hundred (Kolmogorov 1933); low-discrepancy points remain far below.
  const auto points = chebyshev_points(4, 1000, 1);
  for (Eigen::Index d = 0; d < 4; ++d) {
    EXPECT_LT(kolmogorov(points.row(d), arcsine_cdf), 1.63);
    EXPECT_GT(kolmogorov(points.row(d), uniform_cdf), 1.63);  // negative controls: another law ...
  }
  EXPECT_GT(kolmogorov(sobol_points(1, 1000, 1).row(0), arcsine_cdf), 1.63);  // ... and another design
}

TEST(Design, DensitiesAreOfTheirMeasures) {
  for (const auto& row : designs().rows()) {
    // The mean of 1 / density over points of the measure is the volume of the cube, 1; for the arcsine law in two
    // dimensions the sd of 1 / density is 0.66, so 4096 independent points would have the standard error 0.010.
    const auto points = row.entry.points(2, 4096, 1);
    double volume = 0, wrong = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const double density = design_density(row.name, points.col(i));
      volume += 1 / density / double(points.cols());
      wrong += 1 / (density * density) / double(points.cols());
    }
    EXPECT_NEAR(volume, 1, 0.01) << row.name;
    if (row.name == "chebyshev") {
      EXPECT_GT(std::abs(wrong - 1), 0.1);  // negative control
      EXPECT_NEAR(design_density(row.name, Eigen::Vector2d(0.5, 0.5)), std::pow(2 / std::numbers::pi, 2), 1e-12);
      EXPECT_TRUE(std::isfinite(design_density(row.name, Eigen::Vector2d(0, 1))));
    }
  }
}

TEST(Design, PointsAreCarriedToTheBounds) {
  const std::vector<Parameter> two{{.name = "a", .min = -3, .max = -1}, {.name = "b", .min = 1e5, .max = 2e6}};
  const auto unit = sobol_points(2, 64, 9);
  const auto theta = design_points("sobol", two, 64, 9);
  for (Eigen::Index i = 0; i < 64; ++i) {
    EXPECT_DOUBLE_EQ(theta(0, i), -3 + 2 * unit(0, i));
    EXPECT_DOUBLE_EQ(theta(1, i), 1e5 + 1.9e6 * unit(1, i));
  }
  EXPECT_THROW((void)design_points("sobol", {}, 10, 1), InputError);
}
