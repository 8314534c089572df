// Promises that every mechanism keeps, and its keys in the case file.
#include "forward/mechanism/mechanism.hpp"

#include <gmock/gmock.h>

#include <cctype>
#include <set>
#include <tuple>

#include "forward/target/built_in_model.hpp"
#include "tests/unit/forward/target/small_case.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;

namespace {

std::string table(const std::string& name, const std::string& lines = "") { return "[mechanism." + name + "]\nenabled = true\n" + lines; }

std::vector<std::string> built() {
  std::vector<std::string> names;
  for (const auto& name : mechanisms().names())
    if (mechanisms().get(name, "").built()) names.push_back(name);
  return names;
}

Prediction evaluate(const ForwardCase& c, int pulses) { return BuiltInModel(c, {.pulses = pulses}).evaluate({}); }

/// A value within the default prior that is not the off value.
double somewhere(const MechanismKey& k) { return k.log_uniform ? std::sqrt(k.low * k.high) : 0.35 * k.low + 0.65 * k.high; }

}  // namespace

class EveryMechanism : public ::testing::TestWithParam<std::string> {};

TEST(Mechanisms, AllThirteenAreNamed) {
  EXPECT_THAT(mechanisms().names(), ::testing::UnorderedElementsAre("bubbly_liquid", "cavitation_kinetics", "liquid_viscosity", "structural_damping",
                                                                    "nonlinear_eos", "thermal_stress", "beam_profile", "previous_pulses", "rear_reflection",
                                                                    "interface", "sensor_response", "wall_thinning", "static_pressure"));
  EXPECT_EQ(built().size(), 13u);
}

// The bytes are the same, not only close, in single runs, in lanes and in single precision.
TEST_P(EveryMechanism, AtItsOffValuesIsTheBaseModelByteForByte) {
  for (const int pulses : {1, 2})
    for (const char* precision : {"double", "single"}) {
      const std::string solver = "[solver]\nprecision = \"" + std::string(precision) + "\"\n";
      const auto base = evaluate(small_case(solver), pulses), off = evaluate(small_case(solver + table(GetParam())), pulses);
      ASSERT_TRUE(base.ok && off.ok) << off.message;
      EXPECT_EQ(base.mean, off.mean);
      EXPECT_EQ(base.pulses, off.pulses);
    }
}

TEST_P(EveryMechanism, AnyKeyThatDecidesChangesTheHistoriesWhenItIsSet) {
  const auto base = evaluate(small_case(), 1);
  for (const auto& k : mechanisms().get(GetParam(), "").keys) {
    if (!k.decides || k.name == "offset_y" || k.name == "width_ratio_y" || k.name == "transverse") continue;  // nothing changes across y in the slice
    if (GetParam() == "previous_pulses" && k.name.size() > 6) continue;                                       // the first nine states are enough
    const auto on = evaluate(small_case(table(GetParam(), k.name + " = " + number_text(somewhere(k)) + "\n")), 1);
    ASSERT_TRUE(on.ok) << k.name << ": " << on.message;
    EXPECT_NE(base.mean, on.mean) << k.name;
  }
}

TEST_P(EveryMechanism, DefaultPriorsLieWithinWhatTheLawAllows) {
  for (const auto& k : mechanisms().get(GetParam(), "").keys) {
    EXPECT_LE(k.least, k.low) << k.name;
    EXPECT_GE(k.greatest, k.high) << k.name;
    EXPECT_LT(k.low, k.high) << k.name;
    EXPECT_FALSE(k.doc.empty()) << k.name;
  }
}

// A value outside what the law allows is an error that names key, value and range.
TEST_P(EveryMechanism, RefusesValuesOutsideItsRange) {
  for (const auto& k : mechanisms().get(GetParam(), "").keys) {
    if (!std::isfinite(k.least)) continue;
    const double outside = k.least - 1;
    try {
      (void)small_case(table(GetParam(), k.name + " = " + number_text(outside) + "\n"));
      ADD_FAILURE() << k.name << " should have been refused";
    } catch (const InputError& e) {
      EXPECT_EQ(e.parts().key, "mechanism." + GetParam() + '.' + k.name);
      EXPECT_THAT(e.parts().range, HasSubstr(number_text(k.least))) << k.name;
      EXPECT_GT(e.parts().line, 0);
    }
  }
}

TEST_P(EveryMechanism, AMisspeltKeyIsAnErrorWithASuggestion) {
  const std::string key = mechanisms().get(GetParam(), "").keys[0].name;
  try {
    (void)small_case(table(GetParam(), key + "x = 1.0\n"));
    FAIL() << "it should have been refused";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("did you mean \"" + key + '"'));
  }
}

INSTANTIATE_TEST_SUITE_P(Built, EveryMechanism, ::testing::ValuesIn(built()), [](const auto& info) { return info.param; });

// A verdict names the mechanism in words for people who do not know its law.
TEST(Mechanisms, EachHasAPlainNameOfItsOwnAndSomethingToCheck) {
  std::set<std::string> names;
  for (const auto& row : mechanisms().rows()) {
    const auto& [plain, check] = std::tie(row.entry.plain, row.entry.check);
    ASSERT_FALSE(plain.empty() || check.empty()) << row.name;
    for (const std::string& words : {plain, check}) {
      EXPECT_TRUE(std::islower(static_cast<unsigned char>(words.front()))) << words;
      EXPECT_NE(words.back(), '.') << words;
      EXPECT_EQ(words.find_first_of("_=*"), std::string::npos) << words;
    }
    EXPECT_TRUE(names.insert(plain).second) << plain;
  }
}

TEST(Mechanisms, ListedWithoutBeingEnabledChangeNothing) {
  const auto c = small_case("[mechanism.liquid_viscosity]\nzeta = 5000.0\n");
  EXPECT_TRUE(c.mechanisms.empty());
  EXPECT_EQ(evaluate(c, 1).mean, evaluate(small_case(), 1).mean);
}

TEST(Mechanisms, TwoThatReplaceTheLawOfTheLiquidAreRefused) {
  static const MechanismEntry first = mechanisms().get("bubbly_liquid", "");
  ForwardCase c = small_case(table("bubbly_liquid", "alpha0 = 1e-4\n"));
  c.mechanisms.push_back({"another", &first, c.mechanisms[0].values});
  const BuiltInModel model(c, {.pulses = 1});
  const auto p = model.evaluate({});
  EXPECT_FALSE(p.ok);
  EXPECT_THAT(p.message, HasSubstr("mechanism.another.enabled"));
  EXPECT_THAT(p.message, HasSubstr("only one can"));
}

// A parameter whose key names the mechanism fits it.
TEST(Mechanisms, AParameterMovesAKeyFromItsOffValue) {
  const std::string text = table("liquid_viscosity") + "[parameter.z]\nkey = \"mechanism.liquid_viscosity.zeta\"\nmin = 0\nmax = 1e4\n";
  const BuiltInModel model(small_case(text), {.pulses = 1});
  EXPECT_EQ(model.evaluate(std::vector<double>{0}).mean, evaluate(small_case(), 1).mean);
  EXPECT_EQ(model.evaluate(std::vector<double>{3000}).mean, evaluate(small_case(table("liquid_viscosity", "zeta = 3000\n")), 1).mean);
}

// The same through the viscosity of the base model shows that a law in place of Riemer's sees it.
TEST(Mechanisms, ViscosityReachesTheBubblyLiquid) {
  const std::string bubbles = table("bubbly_liquid", "alpha0 = 1e-5\n");
  const auto added = evaluate(small_case(bubbles + table("liquid_viscosity", "zeta = 3000\n")), 1);
  ForwardCase c = small_case(bubbles);
  const double eta = BuiltInModel(c, {.pulses = 1}).describe().viscosity;
  c.mercury.regularising_viscosity = eta + 3000;
  EXPECT_EQ(added.mean, evaluate(c, 1).mean);
  EXPECT_NE(added.mean, evaluate(small_case(bubbles), 1).mean);
}
