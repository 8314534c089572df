#include "uq/sampler/delayed_acceptance.hpp"

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

SamplerOptions delayed(int warmup, int draws) { return {.kind = "delayed_acceptance", .warmup = warmup, .draws = draws, .thin = 1}; }
SamplerStart at(std::size_t d, double place) { return {.mean = Eigen::VectorXd::Constant(Eigen::Index(d), place), .covariance = {}, .points = {}}; }

Gaussian shifted(double by, double scale) {
  Eigen::MatrixXd c(2, 2);
  c << 1, 0.8, 0.8, 1;
  return {Eigen::VectorXd::Constant(2, by), scale * c};
}

}  // namespace

TEST(TwoStages, TheExactDensityIsSampledWhateverTheCheapOneIs) {
  const auto cheap = shifted(0.5, 1.3), exact = shifted(0, 1);
  const auto r = run_sampler(cheap, exact, at(2, 0), delayed(500, 2000), {.seed = 1});
  const auto a = assess(r.quantities, sampling_facts(r, 1));
  EXPECT_TRUE(a.converged) << int(a.finding.state);
  for (const auto& p : a.parameters) {
    EXPECT_LT(std::abs(p.mean), 4 * p.mcse_mean);
    EXPECT_LT(std::abs(p.sd - 1), 4 * p.mcse_sd);
    EXPECT_GT(std::abs(p.mean - 0.5), 4 * p.mcse_mean);         // control: the cheap one's mean
    EXPECT_GT(std::abs(p.sd - std::sqrt(1.3)), 4 * p.mcse_sd);  // and its deviation
  }
  for (std::size_t i = 0; i < r.log_density.size(); ++i) ASSERT_EQ(r.log_density[i], exact.log_density(std::span(r.coordinates.values).subspan(2 * i, 2)));
}

TEST(TwoStages, TheExactDensityIsEvaluatedOnceATransitionAndInTheWarmUpAtItsEndAlone) {
  const auto cheap = shifted(0.2, 1.1), exact = shifted(0, 1);
  const auto r = run_sampler(cheap, exact, at(2, 0), delayed(500, 100), {.seed = 2, .threads = 2});
  EXPECT_EQ(r.summary.evaluations, exact.calls.load());
  EXPECT_LE(exact.calls.load(), 4u * (1 + 20 + 100));
  EXPECT_GE(exact.calls.load(), 4u * 100);
  EXPECT_EQ(r.summary.cheap_evaluations, cheap.calls.load());
  EXPECT_GE(cheap.calls.load(), 4u * 600 * 50);
}

TEST(TwoStages, ACheapDensityThatIsTheExactOneIsNeverRefused) {
  const auto exact = shifted(0, 1);
  const auto r = run_sampler(exact, exact, at(2, 0), delayed(500, 200), {.seed = 3});
  for (const double a : r.acceptance) EXPECT_NEAR(a, 1, 1e-12);
}

TEST(TwoStages, ToleratesAnExactDensityThatIsZeroWhereTheCheapOneIsNot) {
  const Written cheap(1, [](std::span<const double> x) { return -0.125 * x[0] * x[0]; });
  const Written exact(1, [](std::span<const double> x) { return x[0] < 0 ? never : -x[0]; });
  auto options = delayed(500, 10000);
  options.table<DelayedAcceptanceOptions>().first_stage = 5;
  const auto r = run_sampler(cheap, exact, at(1, 0), options, {.seed = 4});
  const auto x = r.quantities.of(0);
  for (const double p : {0.05, 0.5, 0.95}) {
    double below = 0;
    for (const double v : x) below += double(v <= -std::log(1 - p)) / double(x.size());
    const double error = std::sqrt(p * (1 - p) / ess_indicator({x, 4}, -std::log(1 - p)));
    EXPECT_LT(std::abs(below - p), 4 * error) << p;
    EXPECT_GT(std::abs(below - 0.4), 4 * error);  // control
  }
}

TEST(TwoStages, StoppedAndResumedEndsWithTheSameDraws) {
  const auto cheap = shifted(0.2, 1.1), exact = shifted(0, 1);
  expect_resumed_to_the_same_draws(exact, at(2, 0), delayed(60, 100), 100, 3, &cheap);
}

TEST(TwoStages, WithoutASecondDensityItIsRefused) {
  try {
    (void)run_sampler(shifted(0, 1), at(2, 0), delayed(10, 10), {});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("sampler.kind"));
    EXPECT_THAT(e.what(), HasSubstr("dram"));
  }
}

TEST(TwoStages, AnExactDensityThatIsZeroEverywhereIsAnError) {
  const Written exact(2, [](std::span<const double>) { return never; });
  EXPECT_THROW((void)run_sampler(shifted(0, 1), exact, at(2, 0), delayed(30, 10), {}), NumericsError);
}
