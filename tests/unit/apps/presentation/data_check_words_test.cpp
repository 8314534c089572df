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

TEST(DataCheckWords, EveryFindingHasASentence) {
  const ErrorOptions options;
  EXPECT_THAT(data_check_sentences({}, options), IsEmpty());
  const DataChecks checks{.dead = {"S09"},
                          .mislabelled = {{.gauge = "T2", .other = "", .own = -0.98, .like = 0.98}},
                          .clock = ClockOffset{.delay = 3.07e-6, .sd = 0.12e-6, .log_bayes_factor = 75.6},
                          .nuisances = {{.term = "gain", .gauge = "S1", .deviation = 5, .sd = 0.5}}};
  EXPECT_THAT(data_check_sentences(checks, options),
              ElementsAre(plain_dead(checks.dead), mislabelled_sentence(checks.mislabelled[0]),
                          clock_sentence(*checks.clock) + " Omitted physics may look the same: run calomel diagnose.", HasSubstr("the gain of S1")));
}

}  // namespace
}  // namespace calomel
