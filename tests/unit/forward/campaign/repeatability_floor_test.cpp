#include "forward/campaign/repeatability_floor.hpp"

#include <gmock/gmock.h>

#include "base/artefact.hpp"
#include "base/netcdf_file.hpp"
#include "base/provenance.hpp"
#include "forward/campaign/campaign.hpp"
#include "tests/model_simulator.hpp"
#include "tests/scratch.hpp"

using namespace calomel;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

/// Two gauges, three windows; one comparison with numbers, one without.
RepeatabilityFloor example(std::vector<std::string> conditions = {"default"}) {
  RepeatabilityFloor floor;
  floor.members = {{1, 0.3, true, ""}, {0.5, 0.7, false, "an element collapsed"}, {2, 0.45, true, ""}};
  floor.conditions = std::move(conditions);
  floor.sensors = {"A", "B"};
  floor.window_begin = {0, 0.25, 0.5};
  floor.window_end = {0.25, 0.5, 0.6};
  const std::size_t records = 2 * floor.conditions.size();
  for (std::size_t i = 0; i < 3 * records; ++i) floor.sd.push_back(1e-6 / double(i + 3)), floor.signal.push_back(1e-4 / double(i + 7));
  FloorComparison precision{.name = "precision", .what = "single against double", .message = "", .relative = {}, .mean = 2.0 / 7, .worst = 1.0 / 3};
  for (std::size_t i = 0; i < records; ++i) floor.relative.push_back(1 / double(i + 11)), precision.relative.push_back(1 / double(i + 3));
  floor.worst = 1.0 / 11;
  floor.mean = 0.08;
  floor.comparisons = {precision, {.name = "finer_mesh", .what = "half the size", .message = "left out", .relative = {}, .mean = 0, .worst = 0}};
  return floor;
}

/// A line of one parameter at two gauges.
class Line : public ForwardModel {
 public:
  Line() {
    shape_.parameters = {{.name = "a", .key = "a", .min = 0, .max = 1}};
    shape_.conditions = {"default"};
    shape_.sensors = {"A", "B"};
    shape_.times = {0, 0.3, 0.6};
  }
  [[nodiscard]] const ModelShape& shape() const override { return shape_; }
  [[nodiscard]] Prediction evaluate(std::span<const double> theta) const override {
    return {.ok = true, .message = "", .mean = std::vector<double>(6, theta[0])};
  }

 private:
  ModelShape shape_;
};

CampaignSummary run(const std::filesystem::path& dir, const FloorSource& floor) {
  CampaignOptions o;
  o.runs = 5;
  o.pulses = 1;
  const Provenance provenance{.stage = "campaign", .options = {{"campaign", identity_options(o)}}};
  const Line line;
  const ModelSimulator simulator(line);
  const ThreadExecutor one(1);
  RunStore store({.stage = "runs"}, dir / "runs.journal");
  Runs runs(simulator, store, one);
  return run_campaign(
      line.shape(), o, 1, provenance, dir, [&]() -> Runs& { return runs; }, {}, floor);
}

}  // namespace

TEST(RepeatabilityFloor, ComesBackFromItsJsonToTheLastBit) {
  for (const auto& conditions : {std::vector<std::string>{"default"}, {"low", "high"}}) {
    const auto floor = example(conditions);
    const auto back = read_floor(Json::parse(floor_json(floor).dump(2)));
    EXPECT_EQ(back.sd, floor.sd);
    EXPECT_EQ(back.signal, floor.signal);
    EXPECT_EQ(back.relative, floor.relative);
    EXPECT_EQ(back.conditions, floor.conditions);
    EXPECT_EQ(floor_json(back), floor_json(floor));
  }
  EXPECT_THROW((void)read_floor({{"mean", 1}}), InputError);
}

TEST(RepeatabilityFloor, IsMeasuredWhenTheRunsAreFinishedAndKeptInBothFiles) {
  const auto dir = scratch("floor_kept");
  int asked = 0;
  const auto summary = run(dir, [&]() -> std::optional<RepeatabilityFloor> {
    ++asked;
    EXPECT_FALSE(std::filesystem::exists(dir / "campaign.nc"));
    return example();
  });
  EXPECT_EQ(asked, 1);
  EXPECT_EQ(summary.completed, 5u);
  const NetcdfReader file(dir / "campaign.nc");
  const auto floor = example();
  EXPECT_THAT(file.dimensions("floor_sd"), ElementsAre("sensor", "window"));
  EXPECT_EQ(file.doubles("floor_sd"), floor.sd);
  EXPECT_EQ(file.doubles("floor_signal"), floor.signal);
  EXPECT_EQ(file.doubles("floor_relative"), floor.relative);
  EXPECT_EQ(file.doubles("floor_precision"), floor.comparisons[0].relative);
  EXPECT_FALSE(file.has("floor_finer_mesh"));
  EXPECT_EQ(file.doubles("window_end"), floor.window_end);
  EXPECT_EQ(read_json(dir / "campaign.json").at("floor"), floor_json(floor));
}

TEST(RepeatabilityFloor, IsLeftOutWithoutATrace) {
  const auto dir = scratch("floor_none");
  (void)run(dir, {});
  EXPECT_FALSE(NetcdfReader(dir / "campaign.nc").has("floor_sd"));
  EXPECT_FALSE(read_json(dir / "campaign.json").contains("floor"));
}

// What was trained on an archive belongs to its bytes: a floor measured later stands in the summary alone, and remains there.
TEST(RepeatabilityFloor, OfAFinishedCampaignGoesToTheSummaryAlone) {
  const auto dir = scratch("floor_later");
  (void)run(dir, {});
  const auto bytes = read_text(dir / "campaign.nc");
  for (const bool measured : {true, false}) {
    EXPECT_EQ(run(dir, measured ? FloorSource([] { return example(); }) : FloorSource()).reused, 5u);
    EXPECT_EQ(read_json(dir / "campaign.json").at("floor"), floor_json(example()));
  }
  EXPECT_EQ(read_text(dir / "campaign.nc"), bytes);
}

TEST(RepeatabilityFloor, ThatCannotBeMeasuredIsReportedAndCostsNoRun) {
  const auto dir = scratch("floor_failed");
  const auto summary = run(dir, []() -> std::optional<RepeatabilityFloor> { throw NumericsError("the floor needs three finished runs"); });
  EXPECT_THAT(summary.message, HasSubstr("needs three finished runs"));
  EXPECT_EQ(summary.completed, 5u);
  EXPECT_FALSE(read_json(dir / "campaign.json").contains("floor"));
}

// A kill or a stop in the floor leaves every run in the journal.
TEST(RepeatabilityFloor, StoppedInItTheCampaignGoesOnToTheSameBytes) {
  const auto whole = scratch("floor_whole"), dir = scratch("floor_stopped");
  (void)run(whole, [] { return example(); });
  EXPECT_THROW((void)run(dir, []() -> std::optional<RepeatabilityFloor> { throw Interrupted(); }), Interrupted);
  EXPECT_FALSE(std::filesystem::exists(dir / "campaign.nc"));
  EXPECT_EQ(run(dir, [] { return example(); }).reused, 5u);
  EXPECT_EQ(read_text(dir / "campaign.nc"), read_text(whole / "campaign.nc"));
}
