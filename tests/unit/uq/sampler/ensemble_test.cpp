#include "uq/sampler/ensemble.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/unit/uq/sampler/densities.hpp"
#include "tests/unit/uq/sampler/resumed.hpp"
#include "uq/convergence/diagnostics.hpp"
#include "uq/sampler/sampler.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

namespace {

SamplerOptions ensemble(int warmup, int draws, int thin) { return {.kind = "ensemble", .warmup = warmup, .draws = draws, .thin = thin}; }
SamplerStart at(std::size_t d, double place) { return {.mean = Eigen::VectorXd::Constant(Eigen::Index(d), place), .covariance = {}, .points = {}}; }

}  // namespace

TEST(Ensemble, EachMoveAloneSamplesADensityWithAWall) {
  const Written density(1, [](std::span<const double> x) { return x[0] < 0 ? never : -x[0]; });
  for (const double share : {0.0, 0.5, 1.0}) {
    auto options = ensemble(500, 2000, 5);
    options.table<WalkerOptions>().stretch = share;
    const auto r = run_sampler(density, at(1, 1), options, {.seed = 1});
    const auto x = r.quantities.of(0);
    const ChainDraws draws{x, r.quantities.chains, r.quantities.walkers};
    for (const double p : {0.05, 0.25, 0.5, 0.75, 0.95}) {
      double below = 0;
      for (const double v : x) below += double(v <= -std::log(1 - p)) / double(x.size());
      EXPECT_LT(std::abs(below - p) / std::sqrt(p * (1 - p) / ess_indicator(draws, -std::log(1 - p))), 4) << share << " of stretch moves at " << p;
      EXPECT_GT(std::abs(below - (p > 0.5 ? p - 0.04 : p + 0.04)) / std::sqrt(p * (1 - p) / ess_indicator(draws, -std::log(1 - p))), 4);  // control
    }
  }
}

// Without the factor z^(d - 1) of the stretch move, or with an asymmetric difference, the variances of five dimensions would be off.
TEST(Ensemble, EachMoveAloneSamplesSeveralDimensions) {
  Eigen::MatrixXd c = Eigen::MatrixXd::Identity(5, 5);
  c(0, 1) = c(1, 0) = 0.95;
  c(4, 4) = 1e-6;
  const Gaussian density(Eigen::VectorXd::Zero(5), c);
  for (const double share : {0.0, 1.0}) {
    auto options = ensemble(1000, 500, 20);
    options.table<WalkerOptions>().stretch = share;
    const auto r = run_sampler(density, {.mean = Eigen::VectorXd::Zero(5), .covariance = c, .points = {}}, options, {.seed = 2});
    const auto a = assess(r.quantities, sampling_facts(r, options.thin));
    EXPECT_TRUE(a.converged) << int(a.finding.state);
    for (std::size_t k = 0; k < 5; ++k) {
      const double sd = k == 4 ? 1e-3 : 1;
      EXPECT_LT(std::abs(a.parameters[k].mean), 4 * a.parameters[k].mcse_mean);
      EXPECT_LT(std::abs(a.parameters[k].sd - sd), 4 * a.parameters[k].mcse_sd);
      EXPECT_LT(a.parameters[k].mcse_sd, 0.03 * sd);  // an exponent d in place of d - 1 would make sd 1.1
    }
  }
}

TEST(Ensemble, WalkersAreDeclaredAsChainsThatMoveTogether) {
  const auto density = banana();
  const auto r = run_sampler(density, at(2, 1), ensemble(1000, 500, 20), {.seed = 3, .threads = 2});
  EXPECT_EQ(r.quantities.chains, 4 * 8u);
  EXPECT_EQ(r.quantities.walkers, 8u);
  EXPECT_EQ(r.summary.acceptance.size(), 4u);
  EXPECT_EQ(r.log_density.size(), 4 * 8 * 500u);
  EXPECT_EQ(r.acceptance.size(), 4 * 8 * 500u);
  for (std::size_t i = 0; i < r.log_density.size(); ++i) ASSERT_EQ(r.log_density[i], density.log_density(std::span(r.coordinates.values).subspan(2 * i, 2)));
  const auto c = assess(r.quantities, sampling_facts(r, 20));
  EXPECT_TRUE(c.converged) << int(c.finding.state);
  EXPECT_LT(std::abs(c.parameters[1].mean - 2), 4 * c.parameters[1].mcse_mean);
  EXPECT_GT(std::abs(c.parameters[1].mean - 2.5), 4 * c.parameters[1].mcse_mean);  // control
  const auto one = run_sampler(density, at(2, 1), ensemble(1000, 500, 20), {.seed = 3, .threads = 1});
  EXPECT_EQ(one.coordinates.values, r.coordinates.values);
}

// An affine map of the density and of the starts maps the walkers.
TEST(Ensemble, IsTheSameUnderAnAffineMap) {
  Eigen::MatrixXd a(2, 2);
  a << 100, 0, 3, 1e-3;
  Eigen::VectorXd shift(2);
  shift << 1, -7;
  const auto plain = banana();
  const Eigen::MatrixXd back = inverse(a);
  const Written mapped(2, [&](std::span<const double> x) {
    const Eigen::VectorXd y = back * (Eigen::Map<const Eigen::VectorXd>(x.data(), 2) - shift);
    return plain.log_density({y.data(), 2});
  });
  const auto options = ensemble(0, 20, 1);
  const Eigen::VectorXd middle = Eigen::VectorXd::Ones(2);
  const auto p = run_sampler(plain, {.mean = middle, .covariance = {}, .points = {}}, options, {.seed = 4});
  const auto m = run_sampler(mapped, {.mean = a * middle + shift, .covariance = a * a.transpose(), .points = {}}, options, {.seed = 4});
  for (std::size_t i = 0; i < p.log_density.size(); ++i) {
    const Eigen::VectorXd y = a * Eigen::Map<const Eigen::VectorXd>(p.coordinates.values.data() + 2 * i, 2) + shift;
    ASSERT_NEAR(m.coordinates.values[2 * i], y[0], 1e-6 * (1 + std::abs(y[0]))) << i;
    ASSERT_NEAR(m.coordinates.values[2 * i + 1], y[1], 1e-6 * (1 + std::abs(y[1]))) << i;
  }
}

// Differences that are taken whole carry walkers from mode to mode.
TEST(Ensemble, GoesBetweenModes) {
  const Written two(1, [](std::span<const double> x) {
    const double a = std::log(0.3) - 0.5 * std::pow(x[0] + 8, 2), b = std::log(0.7) - 0.5 * std::pow(x[0] - 8, 2);
    return std::max(a, b) + std::log1p(std::exp(-std::abs(a - b)));
  });
  auto options = ensemble(2000, 2000, 10);
  options.table<WalkerOptions>().walkers = 20;
  const auto r = run_sampler(two, {.mean = Eigen::VectorXd::Zero(1), .covariance = Eigen::MatrixXd::Constant(1, 1, 25), .points = {}}, options, {.seed = 5});
  const auto x = r.quantities.of(0);
  const ChainDraws draws{x, r.quantities.chains, r.quantities.walkers};
  double below = 0;
  for (const double v : x) below += double(v < 0) / double(x.size());
  const double error = std::sqrt(0.21 / ess_indicator(draws, 0));
  EXPECT_LT(std::abs(below - 0.3), 4 * error) << below << " ± " << error;
  EXPECT_GT(std::abs(below - 0.5), 4 * error);  // control
}

TEST(Ensemble, StoppedAndResumedEndsWithTheSameDraws) { expect_resumed_to_the_same_draws(banana(), at(2, 1), ensemble(50, 50, 3), 1000, 3); }

TEST(Ensemble, TooFewOrOddWalkersAreTheUsersMistake) {
  const auto density = banana();
  for (const int walkers : {2, 7}) {
    auto options = ensemble(10, 10, 1);
    options.table<WalkerOptions>().walkers = walkers;
    try {
      (void)run_sampler(density, at(2, 1), options, {});
      FAIL();
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr("sampler.ensemble.walkers"));
    }
  }
}
