// Runs by the numbers of the case: never made twice, resumed after any kill, dear ones first.
#include "forward/simulation/run_store.hpp"

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

// A search may end as near to a bound at zero as that.
TEST(RunPoint, ANumberBelowTheSmallestNormalOneReadsBack) {
  const RunPoint tiny{{"mechanism.drag.coefficient", 3e-320}};
  EXPECT_EQ(point_of(text_of(tiny)), tiny);
}

TEST(RunStore, MakesAPointOnceInThisLifeAndTheNext) {
  const auto path = scratch("run_store") / "runs.journal";
  const std::vector<RunPoint> points{coarse, fine, coarse};
  {
    RunStore store(of_test, path);
    const auto runs = store.run(points, quotient, 2);
    ASSERT_EQ(runs.size(), 3u);
    EXPECT_FLOAT_EQ(runs[0].mean[0], 625);
    EXPECT_FLOAT_EQ(runs[1].mean[0], 1250);
    EXPECT_EQ(runs[2], runs[0]);
    EXPECT_EQ(store.made(), 2u);
  }
  RunStore store(of_test, path);
  const auto again = store.run(
      points, [](const RunPoint&) -> RunRecord { throw std::logic_error("nothing is run again"); }, 1);
  EXPECT_FLOAT_EQ(again[1].mean[0], 1250);
  EXPECT_EQ(store.made(), 0u);
  EXPECT_EQ(store.reused(), 2u);
}

TEST(RunStore, TellsItsPointsAndWhyARunFailed) {
  RunStore store(of_test, scratch("run_store_all") / "runs.journal");
  (void)store.run(std::vector<RunPoint>{fine, other}, quotient, 1);
  EXPECT_THAT(store.points(), testing::ElementsAre(other, fine));  // in the order of the texts
  EXPECT_TRUE(store.contains(fine));
  EXPECT_FALSE(store.contains(coarse));
  EXPECT_TRUE(store.read(fine).done);
  EXPECT_FALSE(store.read(other).done);
  EXPECT_EQ(store.read(other).message, "a is negative");
  EXPECT_THROW((void)store.read(coarse), ContractFailure);
}

TEST(RunPoint, HoldsTheParametersByTheirKeysWhateverTheirOrder) {
  const std::vector<Parameter> parameters{{.name = "x", .key = "z.x"}, {.name = "y", .key = "a.y"}};
  const RunPoint p = point_at(parameters, std::vector<double>{1.5, -2});
  EXPECT_EQ(p, (RunPoint{{"a.y", -2}, {"z.x", 1.5}}));
  EXPECT_THAT(theta_at(parameters, p), testing::ElementsAre(1.5, -2));
  EXPECT_THROW((void)theta_at(parameters, {{"a.y", 1}}), ContractFailure);
}

TEST(RunRecord, ComesBackFromItsBytes) {
  RunRecord r{.done = true, .message = "", .mean = {1, 2, 3}, .energy_slope = {4, 5, 6}, .scatter = {}, .pulses = {1, 2, 3, 4, 5, 6}, .energies = {0.99, 1.01}};
  EXPECT_EQ(record_of(bytes_of(r)), r);
  r = {.message = "step 3, element 7"};
  EXPECT_EQ(record_of(bytes_of(r)), r);
  EXPECT_THROW((void)record_of(bytes_of(r).substr(0, 12)), ContractFailure);
  // A record without totals has the bytes that it had before there were any: nothing behind the energies' count and values.
  const RunRecord plain{.done = true, .message = "", .mean = {1, 2, 3}, .energies = {0.99}};
  RunRecord totalled = plain;
  totalled.totals = {0.25, 1e-5};
  EXPECT_EQ(bytes_of(plain).size(), 1 + 6 * sizeof(std::uint64_t) + 3 * sizeof(float) + sizeof(double));
  EXPECT_EQ(bytes_of(totalled).substr(0, bytes_of(plain).size()), bytes_of(plain));
  EXPECT_EQ(record_of(bytes_of(totalled)), totalled);
  EXPECT_TRUE(record_of(bytes_of(plain)).totals.empty());
  r.mean = {0.1f, 1e30f};
  EXPECT_EQ(r.history(), Eigen::Vector2d(double(0.1f), double(1e30f)));
}

TEST(RunStore, BeginsTheDearOnesFirst) {
  RunStore store(of_test, scratch("run_store_cost") / "runs.journal");
  std::vector<double> order;
  (void)store.run(
      std::vector<RunPoint>{coarse, fine, other}, [&](const RunPoint& p) { return order.push_back(p.at("size")), quotient(p); }, 1,
      [](const RunPoint& p) { return 1 / p.at("size"); });
  EXPECT_THAT(order, testing::ElementsAre(1e-3, 2e-3, 2e-3));
}

TEST(RunStore, KeepsWhatWasFinishedWhenItIsStoppedOrCutOff) {
  const auto path = scratch("run_store_cut") / "runs.journal";
  std::atomic<bool> stop = false;
  {
    RunStore store(of_test, path);
    EXPECT_THROW((void)store.run(
                     std::vector<RunPoint>{coarse, fine}, [&](const RunPoint& p) { return stop = true, quotient(p); }, 1, {}, {}, &stop),
                 Interrupted);
  }
  {
    RunStore store(of_test, path);
    EXPECT_EQ(store.size(), 1u);
    (void)store.run(std::vector<RunPoint>{coarse, fine}, quotient, 1);
    EXPECT_EQ(store.made(), 1u);
  }
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 3);  // a write that a kill tore
  RunStore store(of_test, path);
  EXPECT_EQ(store.size(), 1u);
  EXPECT_THAT(store.points(), testing::ElementsAre(coarse));
}

TEST(RunStore, RefusesAJournalOfAnotherCase) {
  const auto path = scratch("run_store_other") / "runs.journal";
  { RunStore store(of_test, path); }
  EXPECT_EQ(RunStore::identity(path), of_test.identity());
  EXPECT_THROW(RunStore(Provenance{.stage = "runs", .options = {{"time", {{"end", 1}}}}, .seed = 3}, path), InputError);
}

}  // namespace
}  // namespace calomel
