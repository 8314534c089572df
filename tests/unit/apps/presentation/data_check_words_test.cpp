// The sentences about data checks.
#include "apps/presentation/data_check_words.hpp"

#include <gmock/gmock.h>

namespace calomel {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(DataCheckWords, AMislabelledChannelIsInvertedOrSwappedOrInAnotherUnit) {
  EXPECT_EQ(mislabelled_sentence({.gauge = "T2", .other = "", .own = -0.98, .like = 0.98}),
            "The record of gauge T2 has the opposite sign of its simulation (correlation -0.98). Check its wiring and its direction in the case.");
  EXPECT_EQ(
      mislabelled_sentence({.gauge = "T3", .other = "B1", .own = 0.31, .like = 0.96}),
      "The record of gauge T3 is like the simulation at B1, and that of B1 like the simulation at T3 (correlation 0.96; 0.31 with its own). Check whether the "
      "two channels are swapped.");
  EXPECT_EQ(
      mislabelled_sentence({.gauge = "T2", .other = "", .own = 0.99, .like = 0.99, .factor = 0.1}),
      "The record of gauge T2 has the simulated shape (correlation 0.99), but 0.1 times the size that the other gauges let expect. Check its unit and its "
      "gain.");
}

TEST(DataCheckWords, AClockIsLateOrEarly) {
  EXPECT_EQ(clock_sentence({.delay = 3.07e-6, .sd = 0.12e-6, .log_bayes_factor = 75.6}),
            "All records look 3.07 \u00b1 0.12 \u00b5s late (log Bayes factor 75.6 to first order). Check the instant from which they count, and set "
            "recordings.trigger_offset; where the instant is not known, set errors.trigger_sd.");
  EXPECT_THAT(clock_sentence({.delay = -2e-3, .sd = 1e-4, .log_bayes_factor = 9}), HasSubstr("2.00 \u00b1 0.10 ms early"));
}

TEST(DataCheckWords, DeadGaugesAreOneOrSeveral) {
  EXPECT_EQ(dead_gauges_sentence(std::vector<std::string>{"C"}),
            "Gauge C records nothing but noise and is left out: see whether it is dead, and name it in recordings.exclude.");
  EXPECT_EQ(dead_gauges_sentence(std::vector<std::string>{"C", "D"}),
            "Gauges C, D record nothing but noise and are left out: see whether they are dead, and name them in recordings.exclude.");
}

TEST(DataCheckWords, AProblemWarnsOfDeadGaugesAndOfNarrowBands) {
  Problem problem;
  problem.shape.sensors = {"A", "B"};
  problem.shape.conditions = {"default"};
  problem.observations.resize(2);
  problem.observations[0].samples = problem.observations[1].samples = 3;
  problem.observations[0].banded_samples = problem.observations[1].banded_samples = 3;
  problem.observations[1].sensor = 1;
  EXPECT_THAT(problem_warnings(problem), IsEmpty());
  problem.warnings = {"two lines of the file were skipped"};
  problem.dead = {"C"};
  problem.observations[1].narrow = 2;
  EXPECT_THAT(problem_warnings(problem), ElementsAre("two lines of the file were skipped", dead_gauges_sentence(problem.dead),
                                                     "samples whose band is narrower than 1 % of the peak are left out of accuracy and delta2: B 2/3"));
  problem = {.shape = problem.shape, .observations = {problem.observations[0]}};
  problem.observations[0].banded_samples = 0;
  EXPECT_THAT(problem_warnings(problem), ElementsAre("no sample has a band of 1 % of its gauge's peak or more: accuracy is not defined and counts as 0"));
}

TEST(DataCheckWords, AParameterFarFromItsPriorIsNamedWithItsKey) {
  ErrorOptions options;
  options.gain_sd = 0.01;
  const std::vector<PriorDeviation> deviations{{.term = "gain", .gauge = "T2", .deviation = 12.9, .sd = 0.5},
                                               {.term = "baseline", .gauge = "T3", .deviation = -2.9}};
  const char* gain =
      "the records shift the gain of T2 by +12.9 of its prior standard deviations (errors.gain_sd), +13 %: its prior is wrong, or it compensates for an "
      "effect that the model omits";
  EXPECT_THAT(far_deviation_sentences(deviations, options), ElementsAre(gain));
  const std::vector<PriorDeviation> many{deviations[0],
                                         {.term = "baseline", .gauge = "T3", .deviation = -4.2},
                                         {.term = "other", .gauge = "", .deviation = 4.1},
                                         {.term = "trigger", .gauge = "", .deviation = 4},
                                         {.term = "trigger", .gauge = "", .deviation = 3.5}};
  EXPECT_THAT(
      far_deviation_sentences(many, options),
      ElementsAre(gain,
                  "the records shift the zero of T3 by -4.2 of its prior standard deviations (errors.baseline): its prior is wrong, or it compensates "
                  "for an effect that the model omits",
                  "the records shift other by +4.1 of its prior standard deviations: its prior is wrong, or it compensates for an effect that the model "
                  "omits; 2 further nuisance parameters also deviate by more than three (mode.pulls)"));
  EXPECT_EQ(nuisance_name("energy scale", ""), "the energy of all pulses");
}

TEST(DataCheckWords, EveryFindingHasASentence) {
  const ErrorOptions options;
  EXPECT_THAT(data_check_sentences({}, options), IsEmpty());
  const DataChecks checks{.dead = {"S09"},
                          .mislabelled = {{.gauge = "T2", .other = "", .own = -0.98, .like = 0.98}},
                          .clock = ClockOffset{.delay = 3.07e-6, .sd = 0.12e-6, .log_bayes_factor = 75.6},
                          .nuisances = {{.term = "gain", .gauge = "S1", .deviation = 5, .sd = 0.5}}};
  EXPECT_THAT(data_check_sentences(checks, options), ElementsAre(dead_gauges_sentence(checks.dead), mislabelled_sentence(checks.mislabelled[0]),
                                                                 clock_sentence(*checks.clock) + " Omitted physics may look the same: run calomel diagnose.",
                                                                 far_deviation_sentences(checks.nuisances, options)[0]));
}

}  // namespace
}  // namespace calomel
