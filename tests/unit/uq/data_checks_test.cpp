// Data checks find each mistake by what it is, nothing where there is none, and mixed-up channels before all that follows from them.
#include "uq/data_checks.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/unit/inverse/posterior/four_gauges.hpp"

namespace calomel {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double far = 3;  ///< prior deviation of a nuisance that is reported

DataChecks checks_of(const Spoilt& spoilt) {
  const FourGauges target(spoilt);
  return check_data(target.inputs, target.fit);
}

std::vector<std::string> far_nuisances(const DataChecks& checks) {
  std::vector<std::string> all;
  for (const auto& n : checks.nuisances)
    if (std::abs(n.deviation) > far) all.push_back(n.term + (n.gauge.empty() ? "" : " of " + n.gauge));
  return all;
}

TEST(DataChecks, FindNothingInRecordsThatAreInOrder) {
  const DataChecks checks = checks_of({});
  EXPECT_THAT(checks.dead, IsEmpty());
  EXPECT_THAT(checks.mislabelled, IsEmpty());
  EXPECT_FALSE(checks.clock);
  EXPECT_THAT(far_nuisances(checks), IsEmpty());
}

TEST(DataChecks, FindAnInvertedChannelAlone) {
  const DataChecks checks = checks_of({.gauge = 2, .gain = -1});
  ASSERT_EQ(checks.mislabelled.size(), 1u);
  EXPECT_EQ(checks.mislabelled[0].gauge, "S2");
  EXPECT_LT(checks.mislabelled[0].own, -0.9);
  EXPECT_FALSE(checks.clock);
  EXPECT_THAT(checks.nuisances, IsEmpty());
}

TEST(DataChecks, FindADeadGaugeAndGoOnWithoutIt) {
  const DataChecks checks = checks_of({.gauge = 2, .gain = 0});
  EXPECT_THAT(checks.dead, ElementsAre("S2"));
  EXPECT_THAT(checks.mislabelled, IsEmpty());
  EXPECT_FALSE(checks.clock);
  EXPECT_THAT(far_nuisances(checks), IsEmpty());
}

TEST(DataChecks, FindAGaugeOfAnotherUnitAlone) {
  const DataChecks checks = checks_of({.gauge = 2, .gain = 0.1});
  ASSERT_EQ(checks.mislabelled.size(), 1u);
  EXPECT_EQ(checks.mislabelled[0].gauge, "S2");
  EXPECT_GT(checks.mislabelled[0].own, 0.9);
  EXPECT_NEAR(checks.mislabelled[0].factor, 0.1, 0.01);
  EXPECT_THAT(checks.nuisances, IsEmpty());
}

TEST(DataChecks, FindAClockThatIsOff) {
  const DataChecks checks = checks_of({.late = 2e-6});
  ASSERT_TRUE(checks.clock);
  EXPECT_GT(checks.clock->delay, 0);
}

TEST(DataChecks, FindANuisanceFarFromItsPrior) {
  const DataChecks checks = checks_of({.gauge = 1, .gain = 1.08});
  EXPECT_THAT(far_nuisances(checks), ElementsAre("gain of S1"));
  EXPECT_THAT(checks.mislabelled, IsEmpty());
  EXPECT_FALSE(checks.clock);
}

// Without an emulator the same prediction and errors give the same findings, but for the clock.
TEST(DataChecks, OfAModelByItselfAreThoseOfItsFit) {
  for (const Spoilt& spoilt : {Spoilt{}, Spoilt{.gauge = 2, .gain = -1}, Spoilt{.gauge = 2, .gain = 0}, Spoilt{.gauge = 1, .gain = 1.08}}) {
    const FourGauges target(spoilt);
    const ErrorModel& errors = target.fit.likeliest().errors;
    const Eigen::VectorXd prediction = target.fit.prediction(target.fit.modes[0].at);
    const FitResidual left = residual_of(errors, prediction, 1), fitted = residual_of(target.fit);
    EXPECT_NEAR(left.chi2, fitted.chi2, 1e-3 * fitted.chi2);  // the emulator's own error is next to nothing
    const DataChecks by_itself = check_data(target.problem, errors, prediction, left), by_fit = check_data(target.inputs, target.fit);
    EXPECT_EQ(by_itself.dead, by_fit.dead);
    EXPECT_EQ(by_itself.mislabelled.size(), by_fit.mislabelled.size());
    EXPECT_FALSE(by_fit.clock);
    EXPECT_EQ(far_nuisances(by_itself), far_nuisances(by_fit));
  }
}

}  // namespace
}  // namespace calomel
