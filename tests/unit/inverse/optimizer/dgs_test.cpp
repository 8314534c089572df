#include "inverse/optimizer/dgs.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/case_file.hpp"
#include "base/random.hpp"

using namespace calomel;

namespace {

const Eigen::Vector3d centre(0.31, 0.62, 0.44);

/// A bowl with ripples of amplitude 0.05 and wavelength 0.08, which has about a hundred local minima in the unit box.
double rippled(const Eigen::VectorXd& x) {
  double f = 0;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const double z = x[k] - centre[k];
    f += 4 * z * z + 0.05 * (1 - std::cos(2 * M_PI * z / 0.08));
  }
  return f;
}
double bowl(const Eigen::VectorXd& x) { return (x - centre).squaredNorm(); }

BatchFunction batched(double (*f)(const Eigen::VectorXd&)) {
  return [f](const Eigen::MatrixXd& points, std::span<double> values) {
    for (Eigen::Index i = 0; i < points.cols(); ++i) values[std::size_t(i)] = f(points.col(i));
  };
}

Eigen::MatrixXd random_starts(Eigen::Index n, std::uint64_t seed) {
  RandomStream random(seed, 0);
  return Eigen::MatrixXd::NullaryExpr(3, n, [&] { return random.uniform(); });
}

double mean_end(const std::vector<DgsTrial>& trials) {
  double sum = 0;
  for (const auto& t : trials) sum += t.f / double(trials.size());
  return sum;
}

}  // namespace

TEST(Dgs, CostsWhatThePaperCounts) {
  // 6 calls for the directions and 20 for the line search, 100 iterations and 50 trials: 130 000 evaluations of a surrogate.
  EXPECT_EQ(dgs_evaluations({}, 3), 26u);
  std::size_t evaluations = 0, calls = 0;
  const BatchFunction counted = [&](const Eigen::MatrixXd& points, std::span<double> values) {
    evaluations += std::size_t(points.cols());
    ++calls;
    batched(bowl)(points, values);
  };
  (void)minimise_dgs(counted, random_starts(50, 1), {}, 100, 1);
  EXPECT_EQ(evaluations, 130000u + 50);
  EXPECT_EQ(calls, 201u);  // all trials in one batch
}

TEST(Dgs, EndsInTheBowl) {
  for (const auto& t : minimise_dgs(batched(bowl), random_starts(20, 2), {}, 100, 1)) {
    EXPECT_LT((t.x - centre).norm(), 2e-3);
    EXPECT_TRUE(std::is_sorted(t.trace.rbegin(), t.trace.rend()));
    EXPECT_EQ(t.trace.size(), 101u);
    EXPECT_EQ(t.trace.back(), t.f);
  }
}

TEST(Dgs, EscapesRipplesWhereALocalGradientDoesNot) {
  const auto starts = random_starts(40, 3);
  const auto smoothed = minimise_dgs(batched(rippled), starts, {}, 100, 1);
  // Negative control: a radius far below the wavelength is the plain gradient, with a line search no longer than a ripple.
  DgsOptions local;
  local.radius = 1e-3;
  local.longest_step = 0.03;
  const auto plain = minimise_dgs(batched(rippled), starts, local, 100, 1);
  int home = 0, plain_home = 0;
  for (std::size_t i = 0; i < smoothed.size(); ++i) home += (smoothed[i].x - centre).norm() < 0.04, plain_home += (plain[i].x - centre).norm() < 0.04;
  EXPECT_GE(home, 30) << "of 40";
  EXPECT_LE(plain_home, 5) << "of 40";
  EXPECT_LT(mean_end(smoothed), 0.2 * mean_end(plain));
}

TEST(Dgs, FindsAnOptimumInACorner) {
  const auto corner = [](const Eigen::MatrixXd& points, std::span<double> values) {
    for (Eigen::Index i = 0; i < points.cols(); ++i) values[std::size_t(i)] = points.col(i).sum();
  };
  for (const auto& t : minimise_dgs(corner, random_starts(10, 4), {}, 60, 1)) {
    EXPECT_LT(t.f, 1e-3);
    EXPECT_GE(t.x.minCoeff(), 0);
  }
}

TEST(Dgs, TrialsDependOnTheirSeedAndIndexAlone) {
  const auto starts = random_starts(6, 5);
  const auto all = minimise_dgs(batched(rippled), starts, {}, 20, 7), few = minimise_dgs(batched(rippled), starts.leftCols(2), {}, 20, 7);
  for (std::size_t t = 0; t < 2; ++t) EXPECT_EQ(all[t].x, few[t].x);
  EXPECT_NE(minimise_dgs(batched(rippled), starts, {}, 20, 8)[0].x, all[0].x);
  DgsOptions fixed;
  fixed.basis = "coordinates";  // no random number is used
  EXPECT_EQ(minimise_dgs(batched(rippled), starts, fixed, 20, 7)[0].x, minimise_dgs(batched(rippled), starts, fixed, 20, 8)[0].x);
}

TEST(Dgs, RequiresDescendingSteps) {
  CaseFile file = CaseFile::from_text("[dgs]\nlongest_step = 0.01\nshortest_step = 0.1\n");
  DgsOptions o;
  EXPECT_THROW(file.read("dgs", o), InputError);
}
