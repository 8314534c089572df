#include "uq/sampler/sampler.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <cmath>
#include <fstream>
#include <thread>

#include "tests/scratch.hpp"
#include "tests/unit/uq/sampler/densities.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/convergence/diagnostics.hpp"
#include "uq/sampler/dram.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

namespace {

Gaussian correlated() {
  Eigen::VectorXd mean(3);
  mean << 1, -2, 30;
  Eigen::MatrixXd c(3, 3);
  c << 1, 0.9, 0, 0.9, 1, 1, 0, 1, 100;
  return {mean, c};
}
SamplerStart about_zero(std::size_t d) { return {.mean = Eigen::VectorXd::Zero(Eigen::Index(d))}; }
const SamplerOptions small{.warmup = 500, .draws = 300, .thin = 2};
SamplerOptions with(SamplerOptions options, const DramOptions& dram) {
  options.table<DramOptions>() = dram;
  return options;
}

Provenance provenance(std::uint64_t seed = 1) { return {.stage = "sample", .options = {{"sampler", {{"draws", 300}}}}, .seed = seed}; }

/// p(x <= bound) of all draws of a quantity, in standard errors from what it should be.
double deviation(const Draws& draws, std::size_t k, double bound, double p) {
  const auto x = draws.of(k);
  double share = 0;
  for (const double v : x) share += (v <= bound) / double(x.size());
  return (share - p) / std::sqrt(p * (1 - p) / ess_indicator({x, draws.chains}, bound));
}

}  // namespace

TEST(Sampler, DrawsFollowAGaussian) {
  const auto density = correlated();
  const auto r = run_sampler(density, about_zero(3), {.warmup = 4000, .draws = 10000}, {.seed = 3});
  ASSERT_EQ(r.coordinates.values.size(), 4 * 10000 * 3u);
  const auto verdict = assess(r.quantities, {.acceptance = r.summary.acceptance[0]});
  EXPECT_TRUE(verdict.converged) << int(verdict.finding.state);
  const double mean[] = {1, -2, 30}, sd[] = {1, 1, 10};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LT(std::abs(deviation(r.quantities, k, mean[k], 0.5)), 4);
    EXPECT_LT(std::abs(deviation(r.quantities, k, mean[k] + 1.6448536 * sd[k], 0.95)), 4);
    EXPECT_GT(std::abs(deviation(r.quantities, k, mean[k] + 0.3 * sd[k], 0.5)), 4);  // control: a wrong median is detected
    EXPECT_NEAR(verdict.parameters[k].sd / sd[k], 1, 4 * verdict.parameters[k].mcse_sd / sd[k]);
  }
  EXPECT_EQ(r.summary.evaluations, density.calls.load());
}

// An error in one chain is reported at once, and the draws of the others are kept.
TEST(Sampler, AChainThatFailsEndsTheOthers) {
  std::atomic<bool> broken{true};
  std::atomic<std::thread::id> first{};
  std::atomic<std::size_t> others{0};
  const Written density(1, [&](std::span<const double> x) {
    std::thread::id nobody;
    if (broken && (first.compare_exchange_strong(nobody, std::this_thread::get_id()) || nobody == std::this_thread::get_id())) {
      while (others < 20000) std::this_thread::yield();
      return std::nan("");
    }
    ++others;
    return -0.5 * x[0] * x[0];
  });
  const SamplerOptions options{.warmup = 500, .draws = 200'000};
  const SamplerRun run{.threads = 4, .journal = scratch("failed") / "posterior.journal", .provenance = provenance()};
  EXPECT_THROW((void)run_sampler(density, about_zero(1), options, run), NumericsError);
  EXPECT_LT(others, 400'000u);  // of a million
  broken = false;
  EXPECT_GT(run_sampler(density, about_zero(1), options, run).summary.resumed, 10'000u);
}

// Delayed rejection with other stages and steps samples the same density, one with a hard wall and two humps.
TEST(Sampler, EveryNumberOfStagesSamplesTheSame) {
  const Written density(1, [](std::span<const double> x) { return x[0] < 0 ? -std::numeric_limits<double>::infinity() : -x[0]; });  // exponential
  for (int stages = 1; stages <= 4; ++stages) {
    const auto r =
        run_sampler(density, {.mean = Eigen::VectorXd::Ones(1)}, with({.warmup = 2000, .draws = 20000}, {.stages = stages, .shrink = 0.4}), {.seed = 5});
    for (const double p : {0.05, 0.25, 0.5, 0.75, 0.95})
      EXPECT_LT(std::abs(deviation(r.quantities, 0, -std::log(1 - p), p)), 4) << stages << " stages at " << p;
    EXPECT_GT(std::abs(deviation(r.quantities, 0, -std::log(0.45), 0.5)), 4);
  }
}

TEST(Sampler, DrawsDependOnTheSeedAloneNotOnThreads) {
  const auto density = correlated();
  const auto one = run_sampler(density, about_zero(3), small, {.seed = 3, .threads = 1});
  const auto four = run_sampler(density, about_zero(3), small, {.seed = 3, .threads = 4});
  const auto other = run_sampler(density, about_zero(3), small, {.seed = 4, .threads = 4});
  EXPECT_EQ(one.coordinates.values, four.coordinates.values);
  EXPECT_EQ(one.log_density, four.log_density);
  EXPECT_EQ(one.acceptance, four.acceptance);
  EXPECT_NE(one.coordinates.values, other.coordinates.values);
  for (std::size_t i = 0; i < 4 * 300; ++i) ASSERT_EQ(one.log_density[i], density.log_density(std::span(one.coordinates.values).subspan(3 * i, 3)));
}

TEST(Sampler, ChainsDoNotDependOnHowManyThereAre) {
  const auto density = correlated();
  auto options = small;
  const auto four = run_sampler(density, about_zero(3), options, {.seed = 3});
  options.chains = 2;
  const auto two = run_sampler(density, about_zero(3), options, {.seed = 3});
  EXPECT_TRUE(std::equal(two.coordinates.values.begin(), two.coordinates.values.end(), four.coordinates.values.begin()));
}

TEST(Sampler, StoppedAndResumedEndsWithTheSameDraws) {
  const auto density = correlated();
  const auto whole = run_sampler(density, about_zero(3), small, {.seed = 3});
  const auto journal = scratch("stopped") / "posterior.journal";
  std::atomic<bool> stop = false;
  std::size_t interruptions = 0;
  const std::size_t before = density.calls;
  for (;;) {
    stop = false;
    // The density itself raises the flag, so that chains stop in the middle of warm-up and of sampling alike.
    struct Stopping : LogDensity {
      const Gaussian& inner;
      std::size_t limit;
      std::atomic<bool>& stop;
      mutable std::atomic<std::size_t> calls{0};
      Stopping(const Gaussian& g, std::size_t l, std::atomic<bool>& s) : inner(g), limit(l), stop(s) {}
      const std::vector<std::string>& coordinates() const override { return inner.coordinates(); }
      double log_density(std::span<const double> x) const override {
        if (++calls > limit) stop = true;
        return inner.log_density(x);
      }
    } stopping(density, 400, stop);
    try {
      const auto r = run_sampler(stopping, about_zero(3), small, {.seed = 3, .threads = 2, .journal = journal, .provenance = provenance(), .stop = &stop});
      EXPECT_EQ(r.coordinates.values, whole.coordinates.values);
      EXPECT_EQ(r.log_density, whole.log_density);
      EXPECT_EQ(r.acceptance, whole.acceptance);
      EXPECT_EQ(r.summary.evaluations, whole.summary.evaluations);
      break;
    } catch (const Interrupted&) {
      ++interruptions;
    }
    ASSERT_LT(interruptions, 100u);
  }
  EXPECT_GT(interruptions, 5u);
  EXPECT_EQ(density.calls - before, whole.summary.evaluations);  // nothing was done twice
  const auto again = run_sampler(density, about_zero(3), small, {.seed = 3, .journal = journal, .provenance = provenance()});
  EXPECT_EQ(again.coordinates.values, whole.coordinates.values);
  EXPECT_EQ(again.summary.resumed, again.summary.transitions);
  remove_journal(journal);
  EXPECT_FALSE(std::filesystem::exists(journal));
}

TEST(Sampler, JournalCutAtAnyByteEndsWithTheSameDraws) {
  const auto density = correlated();
  const SamplerOptions tiny = with({.chains = 2, .warmup = 40, .draws = 30, .thin = 2}, {.adapt_every = 10});
  const auto whole = run_sampler(density, about_zero(3), tiny, {.seed = 3});
  const auto journal = scratch("cut") / "posterior.journal";
  (void)run_sampler(density, about_zero(3), tiny, {.seed = 3, .journal = journal, .provenance = provenance(), .save_every = 0});  // a frame a transition
  const auto size = std::filesystem::file_size(journal);
  for (const double share : {0.0, 0.00001, 0.01, 0.2, 0.37, 0.61, 0.998, 0.9999999}) {
    const auto copy = scratch("cut_again") / "posterior.journal";
    std::filesystem::copy_file(journal, copy);
    std::filesystem::resize_file(copy, std::uintmax_t(share * double(size)));
    const auto r = run_sampler(density, about_zero(3), tiny, {.seed = 3, .threads = 2, .journal = copy, .provenance = provenance()});
    EXPECT_EQ(r.coordinates.values, whole.coordinates.values) << share;
    EXPECT_EQ(r.log_density, whole.log_density) << share;
    EXPECT_EQ(r.summary.evaluations, whole.summary.evaluations) << share;
  }
}

TEST(Sampler, JournalOfOtherSettingsIsRefusedAndKept) {
  const auto density = correlated();
  const auto journal = scratch("other") / "posterior.journal";
  (void)run_sampler(density, about_zero(3), small, {.seed = 3, .journal = journal, .provenance = provenance()});
  const auto size = std::filesystem::file_size(journal);
  try {
    (void)run_sampler(density, about_zero(3), small, {.seed = 4, .journal = journal, .provenance = provenance(4)});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("seed"));
  }
  EXPECT_EQ(std::filesystem::file_size(journal), size);
}

TEST(Sampler, StartsAreWiderThanTheDensityAndInItsSupport) {
  const auto density = correlated();
  SamplerStart start{.mean = Eigen::VectorXd::Zero(3), .covariance = 1e-4 * Eigen::MatrixXd::Identity(3, 3)};
  const SamplerOptions options = with({.chains = 400, .warmup = 0, .draws = 1, .thin = 1}, {.shrink = 1e-6});
  start.mean << 5, 5, 5;
  const auto r = run_sampler(density, start, options, {});
  double square = 0;
  for (std::size_t c = 0; c < 400; ++c) square += std::pow(r.coordinates.at(c, 0, 0) - 5, 2) / 400;
  EXPECT_NEAR(std::sqrt(square), 0.02, 0.004);  // twice the deviation, and a step
  const Written half(1, [](std::span<const double> x) { return x[0] < 0 ? -std::numeric_limits<double>::infinity() : -x[0]; });
  EXPECT_NO_THROW((void)run_sampler(half, {.mean = Eigen::VectorXd::Constant(1, 0.01)}, small, {}));
  const Written nowhere(1, [](std::span<const double>) { return -std::numeric_limits<double>::infinity(); });
  EXPECT_THROW((void)run_sampler(nowhere, about_zero(1), small, {}), NumericsError);
  Eigen::MatrixXd points(1, 4);
  points << 1, 2, -3, 4;
  EXPECT_THROW((void)run_sampler(half, {.points = points}, small, {}), NumericsError);
}

TEST(Sampler, ReportsQuantitiesInNaturalUnits) {
  struct Positive : Gaussian {
    using Gaussian::Gaussian;
    std::vector<std::string> quantities() const override { return {"rho", "c", "rho c"}; }
    void constrain(std::span<const double> x, std::span<double> q) const override { q[0] = std::exp(x[0]), q[1] = std::exp(x[1]), q[2] = q[0] * q[1]; }
  } density(Eigen::VectorXd::Zero(2), Eigen::MatrixXd::Identity(2, 2));
  const auto r = run_sampler(density, about_zero(2), small, {});
  EXPECT_THAT(r.quantities.names, ::testing::ElementsAre("rho", "c", "rho c"));
  EXPECT_DOUBLE_EQ(r.quantities.at(3, 17, 2), std::exp(r.coordinates.at(3, 17, 0) + r.coordinates.at(3, 17, 1)));
}

TEST(Sampler, ReportsAChainThatNeverMoved) {
  const Written spike(1, [](std::span<const double> x) { return -1e18 * x[0] * x[0]; });
  const auto r = run_sampler(spike, {.points = Eigen::MatrixXd::Zero(1, 4)}, {.warmup = 0, .draws = 50}, {});
  EXPECT_FALSE(assess(r.quantities).converged);
}

TEST(Sampler, ProgressCountsToTheEnd) {
  const auto density = correlated();
  std::size_t last = 0, all = 0;
  (void)run_sampler(density, about_zero(3), small, {.threads = 3, .progress = [&](std::size_t done, std::size_t of) {
                                                      EXPECT_GE(done, last);
                                                      last = done;
                                                      all = of;
                                                    }});
  EXPECT_EQ(last, 4 * 1100u);
  EXPECT_EQ(all, last);
}

TEST(Sampler, UnknownKindListsTheKnown) {
  try {
    (void)run_sampler(correlated(), about_zero(3), {.kind = "gibbs"}, {});
    FAIL();
  } catch (const InputError& e) {
    for (const auto& name : samplers().names()) EXPECT_THAT(e.what(), HasSubstr(name));
  }
}

TEST(Sampler, ASecondDensityIsRefusedBySamplersOfOne) {
  const auto density = correlated();
  EXPECT_THROW((void)run_sampler(density, density, about_zero(3), small, {}), InputError);
}
