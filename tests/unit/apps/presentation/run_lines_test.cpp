#include "apps/presentation/run_lines.hpp"

#include <gmock/gmock.h>

using namespace calomel;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(RunLines, TheFloorIsReportedByGaugeWithTheOtherErrors) {
  RepeatabilityFloor floor{
      .members = std::vector<FloorMember>(8), .conditions = {"default"}, .sensors = {"A", "B"}, .relative = {0.0123, 0.04}, .worst = 0.04, .mean = 0.026};
  floor.comparisons = {{.name = "precision", .what = "single against double precision", .relative = {0.0004, 0.0006}, .mean = 0.0005, .worst = 0.0006},
                       {.name = "finer_mesh", .what = "elements of half the size", .message = "left out: too many elements"}};
  EXPECT_THAT(
      floor_lines(floor),
      ElementsAre(
          "repeatability floor of the ensemble mean over 8 jitters of mesh, viscosity and energies: 2.60 % of the signal (mean over sensors), 4.00 % at worst",
          "  A: 1.23 %", "  B: 4.00 %", "single against double precision: 0.05 % (mean over sensors), 0.06 % at worst",
          "elements of half the size: left out: too many elements"));
  floor.conditions = {"low", "high"};
  floor.relative = {0.01, 0.02, 0.03, 0.04};
  const auto lines = floor_lines(floor);
  EXPECT_EQ(lines[2], "  low B: 2.00 %");
  EXPECT_EQ(lines[3], "  high A: 3.00 %");
}

TEST(RunLines, ACampaignReportsItsReusedRuns) {
  EXPECT_EQ(campaign_line({.message = "40 runs"}), "campaign: 40 runs");
  EXPECT_EQ(campaign_line({.message = "40 runs", .reused = 12}), "campaign: 40 runs (12 reused)");
  EXPECT_EQ(failed_note(0), "");
  EXPECT_EQ(failed_note(2), "2 failed");
}

TEST(RunLines, FailuresAreReportedWithTheirReasons) {
  Archive archive;
  archive.shape.parameters = {{.name = "density", .key = "material.mercury.density", .min = 0, .max = 1}};
  archive.theta = Eigen::RowVectorXd::LinSpaced(10, 0, 1);
  archive.status.assign(10, RunStatus::done);
  archive.message.assign(10, "");
  EXPECT_THAT(failure_lines(archive, Feasibility(archive)), IsEmpty());
  for (const std::size_t run : {8u, 9u}) archive.status[run] = RunStatus::failed, archive.message[run] = "step 812: element 40 collapsed";
  const auto lines = failure_lines(archive, Feasibility(archive));
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_THAT(lines[0], HasSubstr("2 of 10 runs of the campaign failed and are left out"));
  EXPECT_THAT(lines[1], testing::AllOf(HasSubstr("  2 x "), HasSubstr("collapsed")));
}

TEST(RunLines, EverySurrogateHasALine) {
  TrainSummary summary;
  summary.surrogates.push_back({.name = "mode network", .n_train = 30, .n_test = 7, .test = {.mae = 3.1e-6, .r2 = 0.9914}});
  EXPECT_THAT(train_lines(summary), ElementsAre("train: mode network on 30 runs, held out 7: R2 0.991, mean absolute error 3.1e-06"));
  EXPECT_THAT(train_lines({}), IsEmpty());
}

TEST(RunLines, WhatIsFoundAndWhatIsMadeFirst) {
  EXPECT_EQ(reused_line("train"), "train: reused");
  EXPECT_EQ(made_first_line("finished campaign", "a.out", "running"), "no finished campaign in a.out: running it first");
  EXPECT_EQ(resumed_line("", 120, false), "simulate: resumes from step 120");
  EXPECT_EQ(resumed_line("low", 120, true), "simulate: condition low is finished and kept");
  EXPECT_EQ(simulate_line({.values = {}, .steps = 160, .elements = 1200, .wall_s = 0.5, .element_steps_per_s = 384000}, 2),
            "simulate: 1200 elements, 160 steps, 0.5 s, 0.384 million element-steps a second");
  EXPECT_EQ(simulate_line({.values = {}, .wall_s = 0.01}, 300), "simulate: 300 values in 0.01 s");
}
