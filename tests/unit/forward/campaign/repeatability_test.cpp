#include "forward/campaign/repeatability.hpp"

#include <gmock/gmock.h>

#include "base/provenance.hpp"
#include "forward/target/target_simulator.hpp"
#include "tests/model_simulator.hpp"
#include "tests/scratch.hpp"
#include "tests/unit/forward/target/small_case.hpp"

using namespace calomel;
using calomel::testing::small_case;
using ::testing::HasSubstr;

namespace {

RepeatabilityFloor floor_of(const ForwardCase& c, const FloorOptions& o, std::uint64_t seed, int threads) {
  const TargetSimulator simulator(c, {});
  RunsInMemory runs(simulator, threads);
  return measure_floor(runs, o, seed);
}

/// The jitters alone.
const FloorOptions options{.members = 4, .mesh_jitter = 0.15, .window = 10e-6, .single_runs = 0, .finer_mesh = false, .precisions = false};

/// What stands beside them, with the fewest jitters.
FloorOptions beside() { return {.members = 3, .window = 10e-6, .single_runs = 3}; }

const FloorComparison& comparison(const RepeatabilityFloor& floor, const std::string& name) {
  for (const auto& c : floor.comparisons)
    if (c.name == name) return c;
  throw std::runtime_error("no comparison " + name);
}

}  // namespace

TEST(Floor, DependsOnTheSeedAloneNotOnThreads) {
  const ForwardCase c = small_case();
  const auto one = floor_of(c, options, 7, 1), two = floor_of(c, options, 7, 2), other = floor_of(c, options, 8, 2);
  EXPECT_EQ(one.sd, two.sd);
  EXPECT_NE(one.sd, other.sd);
}

TEST(Floor, HasAWindowForEveryStretchOfTheRecord) {
  const ForwardCase c = small_case();
  const auto floor = floor_of(c, options, 7, 2);
  ASSERT_EQ(floor.window_begin.size(), std::size_t(std::ceil(c.time.end / options.window - 1e-9)));
  EXPECT_EQ(floor.window_begin.front(), 0);
  EXPECT_DOUBLE_EQ(floor.window_end.back(), c.time.end);
  EXPECT_EQ(floor.sd.size(), floor.window_begin.size() * c.sensors.size());
  EXPECT_GT(floor.mean, 0);
  EXPECT_GE(floor.worst, floor.mean);
}

// The whole record is the windows together: with n_w samples each, relative^2 = sum n_w sd_w^2 / sum n_w signal_w^2.
TEST(Floor, OfTheWholeRecordIsThatOfItsWindows) {
  const ForwardCase c = small_case();
  const auto floor = floor_of(c, options, 7, 2);
  const std::size_t windows = floor.window_begin.size();
  for (std::size_t row = 0; row < floor.relative.size(); ++row) {
    double sd = 0, signal = 0;
    for (std::size_t w = 0; w < windows; ++w) {
      const double n = w + 1 < windows ? 10 : 11;  // the last holds the end of the record
      sd += n * std::pow(floor.sd[row * windows + w], 2);
      signal += n * std::pow(floor.signal[row * windows + w], 2);
    }
    EXPECT_NEAR(floor.relative[row], std::sqrt(sd / signal), 1e-12 * floor.relative[row]);
  }
}

TEST(Floor, GrowsWithTheJitterOfTheMesh) {
  const ForwardCase c = small_case();
  FloorOptions still = options;
  still.mesh_jitter = 0;
  EXPECT_GT(floor_of(c, options, 7, 2).mean, floor_of(c, still, 7, 2).mean);
}

TEST(Floor, NeedsThreeMembers) {
  FloorOptions few = options;
  few.members = 2;
  EXPECT_THROW((void)floor_of(small_case(), few, 7, 1), ContractFailure);
}

TEST(Floor, ReportsTheOtherNumericalErrors) {
  const auto floor = floor_of(small_case(), beside(), 7, 2);
  ASSERT_EQ(floor.comparisons.size(), 3u);
  for (const auto& c : floor.comparisons) {
    EXPECT_EQ(c.message, "") << c.name;
    ASSERT_EQ(c.relative.size(), 2u) << c.name;
    EXPECT_GT(c.mean, 0) << c.name;
    EXPECT_GE(c.worst, c.mean) << c.name;
  }
  // In 40 us chaos has not grown: 1e-6 of the parameters and the rounding of single precision remain far below an element's halving.
  const double finer = comparison(floor, "finer_mesh").mean;
  EXPECT_GT(finer, 0.01);
  EXPECT_LT(comparison(floor, "single_runs").worst, 0.01 * finer);
  EXPECT_LT(comparison(floor, "precision").worst, 0.01 * finer);
}

// Negative controls: equal runs do not scatter at all; a hundredth of the parameters moves them by about that.
TEST(Floor, OfSingleRunsIsOfWhatTheirParametersDifferBy) {
  FloorOptions o = beside();
  o.finer_mesh = o.precisions = false;
  o.single_run_shift = 0;
  EXPECT_EQ(comparison(floor_of(small_case(), o, 7, 2), "single_runs").worst, 0);
  o.single_run_shift = 0.01;
  const double moved = comparison(floor_of(small_case(), o, 7, 2), "single_runs").mean;
  EXPECT_GT(moved, 1e-3);
  EXPECT_LT(moved, 0.1);
}

TEST(Floor, VariesTheCasesOwnParametersInSingleRuns) {
  FloorOptions o = beside();
  o.finer_mesh = o.precisions = false;
  o.single_run_shift = 0.01;
  const auto with = [&](const char* key, const char* bounds) {
    return comparison(floor_of(small_case(std::string("[parameter.p]\nkey = \"") + key + "\"\n" + bounds), o, 7, 2), "single_runs");
  };
  EXPECT_EQ(with("material.mercury.specific_heat", "min = 0\nmax = 1e12\n").worst, 0);  // decides nothing with a given pressure
  EXPECT_GT(with("material.steel.young", "min = 1e6\nmax = 1e12\n").worst, 1e-4);
}

TEST(Floor, ReportsWhyAComparisonIsLeftOut) {
  FloorOptions o = beside();
  // fewer than there are now
  o.single_runs = 0;
  o.precisions = false;
  o.finer_elements = 600;
  const auto floor = floor_of(small_case(), o, 7, 2);
  ASSERT_EQ(floor.comparisons.size(), 1u);
  EXPECT_THAT(floor.comparisons[0].message, HasSubstr("floor.finer_elements"));
  EXPECT_TRUE(floor.comparisons[0].relative.empty());
}

TEST(Floor, StoppedItGoesOnFromItsJournalToTheSameNumbers) {
  const Provenance provenance{.stage = "runs", .options = {{"a", 1}}};
  const auto whole = floor_of(small_case(), beside(), 7, 1);
  const auto path = scratch("floor_stopped") / "runs.journal";
  const TargetSimulator simulator(small_case(), {});
  std::atomic<bool> stop{false};
  std::size_t before = 0, after = 0;
  {
    RunStore store(provenance, path);
    const ThreadExecutor one(1);
    Runs runs(simulator, store, one, &stop);
    EXPECT_THROW((void)measure_floor(runs, beside(), 7,
                                     [&](std::size_t done, std::size_t) {
                                       before = done;
                                       stop = done == 4;
                                     }),
                 Interrupted);
  }
  EXPECT_EQ(before, 4u);
  RunStore store(provenance, path);
  EXPECT_EQ(store.size(), 4u);
  const ThreadExecutor two(2);
  Runs runs(simulator, store, two);
  const auto resumed = measure_floor(runs, beside(), 7, [&](std::size_t, std::size_t total) { after = total; });
  EXPECT_EQ(store.size(), 4 + after);
  EXPECT_EQ(floor_json(resumed), floor_json(whole));
}
