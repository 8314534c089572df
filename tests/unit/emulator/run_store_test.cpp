// Runs by the numbers of the case: never made twice, resumed after any kill, dear ones first.
#include "forward/emulator/run_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "base/provenance.hpp"
#include "tests/scratch.hpp"

namespace calomel {
namespace {

const Provenance of_test{.stage = "runs", .seed = 3};
const RunPoint coarse{{"a", 1.25}, {"size", 2e-3}}, fine{{"a", 1.25}, {"size", 1e-3}}, other{{"a", -0.1}, {"size", 2e-3}};

/// The value of a over the size; fails below a = 0.
RunRecord quotient(const RunPoint& p) {
  if (p.at("a") < 0) return {.message = "a is negative"};
  return {.done = true, .mean = {float(p.at("a") / p.at("size"))}};
}

TEST(RunPoint, TextHoldsEveryDigitAndReadsBack) {
  const RunPoint p{{"material.mercury.density", 13534.123456789012}, {"geometry.element_size", 1.0 / 3}};
  EXPECT_EQ(point_of(text_of(p)), p);
  EXPECT_EQ(point_of(text_of({})), RunPoint{});
  EXPECT_NE(text_of({{"a", 1}}), text_of({{"a", std::nextafter(1.0, 2.0)}}));
}

TEST(RunStore, MakesAPointOnceInThisLifeAndTheNext) {
  const auto directory = scratch("run_store");
  const std::vector<RunPoint> points{coarse, fine, coarse};
  {
    RunStore store(of_test, directory);
    const auto runs = store.run(points, quotient, 2);
    ASSERT_EQ(runs.size(), 3u);
    EXPECT_FLOAT_EQ(runs[0].record.mean[0], 625);
    EXPECT_FLOAT_EQ(runs[1].record.mean[0], 1250);
    EXPECT_EQ(runs[2].record, runs[0].record);
    EXPECT_EQ(store.made(), 2u);
  }
  RunStore store(of_test, directory);
  const auto again = store.run(points, [](const RunPoint&) -> RunRecord { throw std::logic_error("nothing is run again"); }, 1);
  EXPECT_FLOAT_EQ(again[1].record.mean[0], 1250);
  EXPECT_EQ(store.made(), 0u);
  EXPECT_EQ(store.reused(), 2u);
}

TEST(RunStore, TellsAllRunsWithTheirPointsAndWhyOneFailed) {
  RunStore store(of_test, scratch("run_store_all"));
  (void)store.run(std::vector<RunPoint>{fine, other}, quotient, 1);
  const auto all = store.all();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].point, other);  // in the order of the texts
  EXPECT_FALSE(all[0].record.done);
  EXPECT_EQ(all[0].record.message, "a is negative");
  EXPECT_EQ(all[1].point, fine);
}

TEST(RunStore, BeginsTheDearOnesFirst) {
  RunStore store(of_test, scratch("run_store_cost"));
  std::vector<double> order;
  (void)store.run(std::vector<RunPoint>{coarse, fine, other}, [&](const RunPoint& p) { return order.push_back(p.at("size")), quotient(p); }, 1,
                  [](const RunPoint& p) { return 1 / p.at("size"); });
  EXPECT_THAT(order, testing::ElementsAre(1e-3, 2e-3, 2e-3));
}

TEST(RunStore, KeepsWhatWasFinishedWhenItIsStoppedOrCutOff) {
  const auto directory = scratch("run_store_cut");
  std::atomic<bool> stop = false;
  {
    RunStore store(of_test, directory);
    EXPECT_THROW((void)store.run(std::vector<RunPoint>{coarse, fine}, [&](const RunPoint& p) { return stop = true, quotient(p); }, 1, {}, {}, &stop), Interrupted);
  }
  {
    RunStore store(of_test, directory);
    EXPECT_EQ(store.size(), 1u);
    (void)store.run(std::vector<RunPoint>{coarse, fine}, quotient, 1);
    EXPECT_EQ(store.made(), 1u);
  }
  const auto journal = directory / "runs.journal";
  std::filesystem::resize_file(journal, std::filesystem::file_size(journal) - 3);  // a write that a kill tore
  RunStore store(of_test, directory);
  EXPECT_EQ(store.size(), 1u);
  EXPECT_EQ(store.all()[0].point, coarse);
}

TEST(RunStore, RefusesAJournalOfAnotherCase) {
  const auto directory = scratch("run_store_other");
  { RunStore store(of_test, directory); }
  EXPECT_THROW(RunStore(Provenance{.stage = "runs", .options = {{"time", {{"end", 1}}}}, .seed = 3}, directory), InputError);
}

}  // namespace
}  // namespace calomel
