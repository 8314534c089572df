// What a fit says against its own case: each slip by what it is, nothing where there is none, and gauges that are mixed up before all that follows from them.
#include "uq/slips.hpp"

#include <gmock/gmock.h>

#include "tests/unit/inverse/posterior/four_gauges.hpp"

namespace calomel {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> told(const Spoilt& spoilt) {
  const FourGauges target(spoilt);
  return slips(target.inputs, target.fit);
}

TEST(Slips, AreNotToldOfRecordsThatAreRight) { EXPECT_THAT(told({}), IsEmpty()); }

TEST(Slips, TellAGaugeOfTheOtherSignAlone) { EXPECT_THAT(told({.gauge = 2, .gain = -1}), ElementsAre(AllOf(HasSubstr("S2"), HasSubstr("the other sign")))); }

TEST(Slips, TellAClockThatIsOff) {
  EXPECT_THAT(told({.late = 2e-6}), Contains(AllOf(HasSubstr("All records look"), HasSubstr("late"), HasSubstr("calomel diagnose"))));
}

TEST(Slips, TellWhatTheRecordsPullFar) { EXPECT_THAT(told({.gauge = 1, .gain = 1.08}), ElementsAre(HasSubstr("the gain of S1"))); }

}  // namespace
}  // namespace calomel
