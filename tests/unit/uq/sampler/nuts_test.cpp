#include "uq/sampler/nuts.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/unit/uq/sampler/densities.hpp"
#include "tests/unit/uq/sampler/resumed.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/convergence/diagnostics.hpp"
#include "uq/sampler/sampler.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

/// Ten normals of sds 1, 2, ... 10, and an exponential behind a wall as the last.
Sloped walled() {
  return {11, [](std::span<const double> x, std::span<double> g) {
            double sum = 0;
            for (std::size_t k = 0; k < 10; ++k) g[k] = -x[k] / std::pow(double(k + 1), 2), sum += 0.5 * x[k] * g[k];
            g[10] = -1;
            return x[10] < 0 ? never : sum - x[10];
          }};
}

/// d standard normals, each `scale` wide.
Sloped normals(std::size_t d, double scale = 1) {
  return {d, [scale](std::span<const double> x, std::span<double> g) {
            double sum = 0;
            for (std::size_t k = 0; k < x.size(); ++k) g[k] = -x[k] / (scale * scale), sum += 0.5 * x[k] * g[k];
            return sum;
          }};
}

/// Neal 2003, The Annals of Statistics 31, 705, section 8: v ~ N(0, 3), x_k | v ~ N(0, exp(v / 2)).
Sloped funnel() {
  return {6, [](std::span<const double> x, std::span<double> g) {
            const double v = x[0], narrow = std::exp(-v);
            double squares = 0;
            for (std::size_t k = 1; k < 6; ++k) squares += x[k] * x[k], g[k] = -narrow * x[k];
            g[0] = -v / 9 + 0.5 * narrow * squares - 2.5;
            return -v * v / 18 - 0.5 * narrow * squares - 2.5 * v;
          }};
}

SamplerOptions nuts(int warmup, int draws) { return {.kind = "nuts", .warmup = warmup, .draws = draws, .thin = 1}; }
SamplerStart about(std::size_t d, double place) { return {.mean = Eigen::VectorXd::Constant(Eigen::Index(d), place), .covariance = {}, .points = {}}; }

}  // namespace

TEST(Nuts, DrawsFollowABentDensity) {
  const auto density = banana();
  auto options = nuts(1000, 3000);
  options.table<NutsOptions>().target = 0.98;  // below, trajectories diverge in its tails
  const auto r = run_sampler(density, about(2, 1), options, {.seed = 5});
  const auto c = assess(r.quantities, sampling_facts(r, 1));
  EXPECT_TRUE(c.converged) << int(c.finding.state);
  const auto& y = c.parameters[1];
  EXPECT_LT(std::abs(c.parameters[0].mean - 1), 4 * c.parameters[0].mcse_mean);
  EXPECT_LT(std::abs(c.parameters[0].sd - 1), 4 * c.parameters[0].mcse_sd);
  EXPECT_LT(std::abs(y.mean - 2), 4 * y.mcse_mean);
  EXPECT_LT(std::abs(y.sd - std::sqrt(6.5)), 4 * y.mcse_sd);
  EXPECT_GT(std::abs(y.mean - 2.5), 4 * y.mcse_mean);  // control: another mean is detected
  for (std::size_t i = 0; i < 4 * 3000; ++i) ASSERT_EQ(r.log_density[i], density.log_density(std::span(r.coordinates.values).subspan(2 * i, 2)));
}

TEST(Nuts, DrawsFollowManyScalesAndAWallWithEitherMetric) {
  const auto density = walled();
  for (const char* metric : {"dense", "diagonal"}) {
    auto options = nuts(1000, 2000);
    options.table<NutsOptions>().metric = metric;
    const auto r = run_sampler(density, about(11, 1), options, {.seed = 6});
    const auto c = assess(r.quantities, sampling_facts(r, 1));
    EXPECT_TRUE(c.converged) << int(c.finding.state);
    for (std::size_t k = 0; k < 10; ++k) {
      EXPECT_LT(std::abs(c.parameters[k].mean), 4 * c.parameters[k].mcse_mean) << k;
      EXPECT_LT(std::abs(c.parameters[k].sd - double(k + 1)), 4 * c.parameters[k].mcse_sd) << k;
    }
    EXPECT_LT(std::abs(c.parameters[10].mean - 1), 4 * c.parameters[10].mcse_mean);
    EXPECT_GT(r.summary.divergences, 0u);  // trajectories that leave the support
    EXPECT_EQ(c.divergences, r.summary.divergences);
    EXPECT_EQ(c.finding.transitions, 8000u);
  }
}

// Energies of a normal density have a known distribution: E = U + K, each chi-squared of d freedoms over 2.
TEST(Nuts, DrawsAreNearlyIndependentAndEnergiesAreThoseOfTheDensity) {
  const auto density = normals(3);
  const auto r = run_sampler(density, about(3, 0), nuts(500, 2000), {.seed = 7});
  const auto c = assess(r.quantities, sampling_facts(r, 1));
  for (const auto& p : c.parameters) EXPECT_GT(p.ess_bulk, 0.5 * 8000);
  for (const double a : r.summary.acceptance) EXPECT_NEAR(a, 0.8, 0.12);
  double mean = 0;
  for (const double e : r.energy) mean += e / double(r.energy.size());
  EXPECT_LT(std::abs(mean - 3), 4 * mcse_mean({r.energy, 4}));
  EXPECT_GT(std::abs(mean - 3.5), 4 * mcse_mean({r.energy, 4}));  // control
  for (const double e : r.summary.e_bfmi) EXPECT_GT(e, 0.7);
  EXPECT_EQ(r.summary.divergences, 0u);
}

TEST(Nuts, WarmUpFindsScalesThatAreMillionsOff) {
  const auto tiny = normals(2, 1e-6);
  const auto r =
      run_sampler(tiny, {.mean = Eigen::VectorXd::Zero(2), .covariance = {}, .points = Eigen::MatrixXd::Constant(2, 4, 1e-6)}, nuts(1000, 1000), {.seed = 8});
  const auto c = assess(r.quantities, sampling_facts(r, 1));
  EXPECT_TRUE(c.converged) << int(c.finding.state);
  EXPECT_NEAR(c.parameters[0].sd, 1e-6, 4 * c.parameters[0].mcse_sd);
  EXPECT_LT(double(r.summary.evaluations), 20.0 * double(r.summary.transitions));
}

TEST(Nuts, AFunnelIsNotCalledConverged) {
  const auto density = funnel();
  const auto r = run_sampler(density, about(6, 0), nuts(1000, 1000), {.seed = 9});
  const auto c = assess(r.quantities, sampling_facts(r, 1));
  EXPECT_FALSE(c.converged) << int(c.finding.state);
  EXPECT_GT(r.summary.divergences, 0u);
  EXPECT_EQ(c.finding.state, ChainState::divergences);
  EXPECT_EQ(c.finding.remedies.accuracy_key, "sampler.nuts.target");
}

TEST(Nuts, DoublingsEndAtTheDepthThatIsAllowed) {
  const auto density = normals(1, 100);
  auto options = nuts(0, 50);  // steps of 0.5 where 300 would do
  options.table<NutsOptions>().depth = 3;
  const auto r = run_sampler(density, about(1, 0), options, {.seed = 10});
  EXPECT_EQ(r.summary.cut, r.summary.transitions);
  for (const double depth : r.depth) EXPECT_EQ(depth, 3);
  EXPECT_EQ(r.summary.evaluations, 4u + r.summary.transitions * (1 + 1 + 2 + 4));
  EXPECT_EQ(sampling_facts(r, 1).cut, sampling_facts(r, 1).transitions);
}

TEST(Nuts, WindowsOfTheWarmUpDoubleAndTheLastReachesItsEnd) {
  EXPECT_THAT(warmup_windows(1000), ElementsAre(75, 100, 150, 250, 450, 950));  // Stan's own example
  EXPECT_THAT(warmup_windows(160), ElementsAre(75, 110));
  EXPECT_THAT(warmup_windows(100), ElementsAre(15, 90));
  EXPECT_THAT(warmup_windows(10), ::testing::IsEmpty());
}

TEST(Nuts, StoppedAndResumedEndsWithTheSameDraws) { expect_resumed_to_the_same_draws(banana(), about(2, 1), nuts(250, 200), 2000, 3); }

TEST(Nuts, ADensityWithoutAGradientIsRefusedWithAWayOut) {
  const Written density(1, [](std::span<const double> x) { return -x[0] * x[0]; });
  try {
    (void)run_sampler(density, about(1, 0), nuts(10, 10), {});
    FAIL();
  } catch (const InputError& e) {
    for (const char* word : {"gradient", "sampler.kind", "dram", "ensemble", "smc"}) EXPECT_THAT(e.what(), HasSubstr(word));
  }
}

TEST(Nuts, AGradientThatIsNaNIsADefectOfTheDensityAndNamesThePlace) {
  const Sloped density(1, [](std::span<const double> x, std::span<double> g) {
    g[0] = x[0] > 0.5 ? std::nan("") : -x[0];
    return -0.5 * x[0] * x[0];
  });
  try {
    (void)run_sampler(density, about(1, 0), nuts(100, 100), {});
    FAIL();
  } catch (const NumericsError& e) {
    EXPECT_THAT(e.what(), HasSubstr("x1 = "));
    EXPECT_THAT(e.what(), HasSubstr("gradient"));
  }
}
