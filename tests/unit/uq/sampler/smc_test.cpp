#include "uq/sampler/smc.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "tests/unit/uq/sampler/conjugate.hpp"
#include "tests/unit/uq/sampler/densities.hpp"
#include "tests/unit/uq/sampler/resumed.hpp"
#include "uq/convergence/diagnostics.hpp"
#include "uq/sampler/sampler.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

namespace {

SamplerOptions smc(int chains, int draws) { return {.kind = "smc", .chains = chains, .warmup = 500, .draws = draws, .thin = 1}; }
SamplerStart at(std::size_t d, double place) { return {.mean = Eigen::VectorXd::Constant(Eigen::Index(d), place), .covariance = {}, .points = {}}; }

/// Estimates lie within four standard errors of the truth, and these errors are small enough to detect a truth that is off by `off`.
void expect_evidence(const SamplerSummary& s, double known, double off) {
  ASSERT_TRUE(s.log_evidence && s.log_evidence_error);
  EXPECT_LT(std::abs(*s.log_evidence - known), 4 * *s.log_evidence_error) << *s.log_evidence << " ± " << *s.log_evidence_error << ", known " << known;
  EXPECT_GT(std::abs(*s.log_evidence - (known + off)), 4 * *s.log_evidence_error);
  EXPECT_LT(std::abs(*s.log_evidence - known), off);
}

}  // namespace

TEST(Smc, EvidenceOfAGaussianIsItsIntegral) {
  Eigen::MatrixXd c(3, 3);
  c << 1, 0.9, 0, 0.9, 1, 1, 0, 1, 100;
  Eigen::VectorXd mean(3);
  mean << 1, -2, 5;
  const Gaussian density(mean, c);
  const auto r = run_sampler(density, at(3, 0), smc(8, 1000), {.seed = 1});
  expect_evidence(r.summary, 1.5 * std::log(2 * std::numbers::pi) + Cholesky(c).half_log_determinant(), 0.3);
  const auto verdict = assess(r.quantities, sampling_facts(r, 1));
  EXPECT_TRUE(verdict.converged) << int(verdict.finding.state);
  EXPECT_NEAR(verdict.parameters[2].sd, 10, 4 * verdict.parameters[2].mcse_sd);
  EXPECT_EQ(r.summary.evaluations, density.calls.load());
}

// Raiffa and Schlaifer 1961: the evidence of normal data with a normal-inverse-gamma prior is a ratio of gamma functions.
TEST(Smc, EvidenceOfAConjugateModelIsKnownAndADroppedJacobianIsDetected) {
  const std::vector<double> data{3.6, 0.9, 8.7, 5.1, -1.2, 2.4};
  const ConjugateNormal model(data), dropped(data, false);
  const auto r = run_sampler(model, at(2, 0), smc(8, 1000), {.seed = 2});
  expect_evidence(r.summary, model.log_evidence(), 0.15);
  const auto wrong = run_sampler(dropped, at(2, 0), smc(8, 1000), {.seed = 2});
  EXPECT_GT(std::abs(*wrong.summary.log_evidence - model.log_evidence()), 4 * *wrong.summary.log_evidence_error);
}

TEST(Smc, StandardErrorOfTheEvidenceIsWhatRepeatsShow) {
  const auto density = banana();
  const double known = std::log(2 * std::numbers::pi) - 0.5 * std::log(2.0);
  double squares = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const auto r = run_sampler(density, at(2, 1), smc(8, 100), {.seed = seed});
    squares += std::pow((*r.summary.log_evidence - known) / *r.summary.log_evidence_error, 2) / 30;
  }
  // Mean square of Student's t of 7 degrees of freedom: 7 / 5, its standard deviation over 30 repeats 0.5.
  EXPECT_GT(squares, 0.5);
  EXPECT_LT(squares, 1.4 + 4 * 0.5);
}

TEST(Smc, DrawsFollowABentDensityAndAWall) {
  const auto bent = banana();
  const auto r = run_sampler(bent, at(2, 0), smc(4, 2000), {.seed = 3});
  const auto c = assess(r.quantities, sampling_facts(r, 1));
  EXPECT_TRUE(c.converged) << int(c.finding.state);
  EXPECT_LT(std::abs(c.parameters[1].mean - 2), 4 * c.parameters[1].mcse_mean);
  EXPECT_GT(std::abs(c.parameters[1].mean - 2.5), 4 * c.parameters[1].mcse_mean);  // control
  for (std::size_t i = 0; i < 4 * 2000; ++i) ASSERT_EQ(r.log_density[i], bent.log_density(std::span(r.coordinates.values).subspan(2 * i, 2)));
  const Written wall(1, [](std::span<const double> x) { return x[0] < 0 ? never : -x[0]; });
  const auto w = run_sampler(wall, at(1, 0), smc(8, 1000), {.seed = 4});
  for (const double x : w.coordinates.values) ASSERT_GE(x, 0);
  expect_evidence(w.summary, 0, 0.15);  // half of the first particles are nowhere
  const auto x = w.quantities.of(0);
  EXPECT_LT(std::abs(ess_mean({x, 8}) > 0 ? (assess(w.quantities).parameters[0].mean - 1) / mcse_mean({x, 8}) : 99), 4);
}

// Weights of two modes that no random walk crosses; chains that remain in one mode cannot estimate them.
TEST(Smc, EstimatesTheWeightsOfSeparateModes) {
  const Written two(1, [](std::span<const double> x) {
    const double a = std::log(0.3) - 0.5 * std::pow(x[0] + 8, 2), b = std::log(0.7) - 0.5 * std::pow(x[0] - 8, 2);
    return std::max(a, b) + std::log1p(std::exp(-std::abs(a - b)));
  });
  const auto r =
      run_sampler(two, {.mean = Eigen::VectorXd::Zero(1), .covariance = Eigen::MatrixXd::Constant(1, 1, 25), .points = {}}, smc(16, 500), {.seed = 5});
  std::vector<double> shares(16, 0.0);
  for (std::size_t c = 0; c < 16; ++c)
    for (std::size_t i = 0; i < 500; ++i) shares[c] += double(r.coordinates.at(c, i, 0) < 0) / 500;
  double mean = 0, squares = 0;
  for (const double s : shares) mean += s / 16;
  for (const double s : shares) squares += (s - mean) * (s - mean);
  const double error = std::sqrt(squares / 15 / 16);
  EXPECT_LT(std::abs(mean - 0.3), 4 * error) << mean << " ± " << error;
  EXPECT_GT(std::abs(mean - 0.5), 4 * error);  // control: equal weights
}

// Particles that hardly move share ancestors. In the order of descent that is seen; shuffled, it is not.
TEST(Smc, WhatRelativesHaveInCommonCountsAgainstTheEffectiveSampleSize) {
  const Gaussian density(Eigen::VectorXd::Zero(5), Eigen::MatrixXd::Identity(5, 5));
  auto options = smc(200, 400);
  options.table<SmcOptions>() = {.keep = 0.5, .correlation = 0.99, .sweeps = 1};
  const auto r = run_sampler(density, at(5, 1), options, {.seed = 6});
  const auto first = r.coordinates.of(0);
  double variance = 0;
  double reported = 0;
  double shuffled = 0;
  RandomStream random(1, 0);
  for (std::size_t c = 0; c < 200; ++c) {
    std::vector<double> x(first.begin() + std::ptrdiff_t(400 * c), first.begin() + std::ptrdiff_t(400 * (c + 1))), y(400);
    double mean = 0;
    for (const double v : x) mean += v / 400;
    const auto order = random.permutation(400);
    for (std::size_t i = 0; i < 400; ++i) y[i] = x[order[i]];
    variance += mean * mean / 200;
    reported += std::pow(mcse_mean({x, 1}), 2) / 200;
    shuffled += std::pow(mcse_mean({y, 1}), 2) / 200;
  }
  EXPECT_GT(reported / variance, 0.5) << "reported " << std::sqrt(reported) << ", found " << std::sqrt(variance);
  EXPECT_LT(reported / variance, 2);
  EXPECT_LT(shuffled / variance, 0.5);  // control: the estimate from a random order
}

TEST(Smc, StoppedAndResumedEndsWithTheSameDraws) { expect_resumed_to_the_same_draws(banana(), at(2, 1), smc(3, 100), 3000, 3); }

TEST(Smc, AWarmUpThatIsTooShortIsMadeUpForBeforeTheFirstDraw) {
  const auto density = banana();
  auto options = smc(2, 100);
  const auto whole = run_sampler(density, at(2, 1), options, {.seed = 7});
  options.warmup = 3;
  const auto brief = run_sampler(density, at(2, 1), options, {.seed = 7});
  EXPECT_EQ(whole.coordinates.values, brief.coordinates.values);
  EXPECT_EQ(whole.summary.log_evidence, brief.summary.log_evidence);
}

TEST(Smc, ADensityThatIsZeroAtAllParticlesIsAnError) {
  const Written far(1, [](std::span<const double> x) { return std::abs(x[0]) < 1e-9 ? 0.0 : never; });
  EXPECT_THROW((void)run_sampler(far, {.mean = {}, .covariance = {}, .points = Eigen::MatrixXd::Zero(1, 4)}, smc(4, 50), {}), NumericsError);
}

// A density on which particles hardly move ends at its budget, and says how far it came; with more it goes on from its journal to the draws of a run that was
// never cut off.
TEST(Smc, ItsBudgetEndsItAndMoreGoesOn) {
  const auto density = banana();
  SamplerOptions options = smc(2, 500);
  SamplerRun run{.seed = 4, .journal = scratch("smc_budget") / "chains.journal", .provenance = provenance_of(options), .save_every = 0};
  const auto whole = run_sampler(density, at(2, 0), options, {.seed = 4});
  options.table<SmcOptions>().evaluations = int(whole.summary.evaluations / 4);
  try {
    (void)run_sampler(density, at(2, 0), options, run);
    FAIL() << "it went on beyond its budget";
  } catch (const NumericsError& e) {
    EXPECT_THAT(e.what(), HasSubstr("sampler.smc.evaluations"));
    EXPECT_THAT(e.what(), HasSubstr("500 particles"));
  }
  options.table<SmcOptions>().evaluations = 1'000'000;
  const auto resumed = run_sampler(density, at(2, 0), options, run);
  EXPECT_GT(resumed.summary.resumed, 0u);
  EXPECT_EQ(resumed.coordinates.values, whole.coordinates.values);
}
