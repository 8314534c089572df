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

TEST(Slips, TellADeadGaugeAndGoOnWithoutIt) { EXPECT_THAT(told({.gauge = 2, .gain = 0}), ElementsAre(HasSubstr("Gauge S2 records nothing but noise"))); }

TEST(Slips, TellAGaugeOfAnotherUnitAlone) {
  EXPECT_THAT(told({.gauge = 2, .gain = 0.1}), ElementsAre(AllOf(HasSubstr("S2 reads 0.1 times"), HasSubstr("unit"))));
}

TEST(Slips, TellAClockThatIsOff) {
  EXPECT_THAT(told({.late = 2e-6}), Contains(AllOf(HasSubstr("All records look"), HasSubstr("late"), HasSubstr("calomel diagnose"))));
}

TEST(Slips, TellWhatTheRecordsPullFar) { EXPECT_THAT(told({.gauge = 1, .gain = 1.08}), ElementsAre(HasSubstr("the gain of S1"))); }

// Without an emulator: the same sentences from the same prediction and errors.
TEST(Slips, OfAModelByItselfAreThoseOfItsFit) {
  for (const Spoilt& spoilt : {Spoilt{}, Spoilt{.gauge = 2, .gain = -1}, Spoilt{.gauge = 2, .gain = 0}, Spoilt{.gauge = 1, .gain = 1.08}}) {
    const FourGauges target(spoilt);
    const ErrorModel& errors = target.fit.likeliest().errors;
    const Eigen::VectorXd prediction = target.fit.prediction(target.fit.modes[0].at);
    const FitResidual left = residual_of(errors, prediction, 1), fitted = residual_of(target.fit);
    EXPECT_NEAR(left.chi2, fitted.chi2, 1e-3 * fitted.chi2);  // the emulator's own error is next to nothing
    EXPECT_EQ(slips(target.problem, target.inputs.errors, errors, prediction, left).size(), slips(target.inputs, target.fit).size());
  }
}

}  // namespace
}  // namespace calomel
