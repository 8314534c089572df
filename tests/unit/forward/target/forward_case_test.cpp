#include "forward/target/forward_case.hpp"

#include <gmock/gmock.h>

#include <fmt/format.h>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/scratch.hpp"
#include "tests/unit/forward/target/small_case.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

const std::string parameters = R"(
[parameter.tensile_cutoff]
min = 0.0
max = 1.5e6
[parameter.density]
min = 1350
max = 13600
nominal = 13000
[parameter.gain]
key = "sensor.T.gain"
min = 0.8
max = 1.2
[parameter.nu]
key = "material.steel.poisson"
min = 0.2
max = 0.35
)";

std::string complaint(const std::string& more) {
  try {
    (void)small_case(more);
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

/// What is said of a case with these sensors in a file.
std::string complaint_of_sensors(const std::string& rows) {
  const auto folder = scratch("sensors");
  write_atomically(folder / "gauges.csv", rows);
  std::string text = small_case_text();
  text = "sensors = \"gauges.csv\"\n" + text.substr(0, text.find("[[sensor]]"));
  write_atomically(folder / "case.toml", text);
  try {
    CaseFile file(folder / "case.toml");
    (void)ForwardCase::read(file);
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

}  // namespace

TEST(ForwardCase, ATableOfSensorsIsHeldToItsLines) {
  const std::string head = "name,x,y,z,dx,dy,dz,gauge_length\n", row = "A,0.02,0,0.03,1,0,0,0.003\n";
  EXPECT_EQ(complaint_of_sensors(head + row), "no error");
  EXPECT_THAT(complaint_of_sensors(head + row + row), AllOf(HasSubstr("gauges.csv:3: "), HasSubstr("two sensors have the same name")));
  EXPECT_THAT(complaint_of_sensors(head + "A,nan,0,0.03,1,0,0\n"), AllOf(HasSubstr("gauges.csv:2: "), HasSubstr("numbers are expected")));
  EXPECT_THAT(complaint_of_sensors(head + "A,0.02mm,0,0.03,1,0,0\n"), AllOf(HasSubstr("gauges.csv:2: "), HasSubstr("numbers are expected")));
  EXPECT_THAT(complaint_of_sensors("nmae,x,y,z,dx,dy,dz\n" + row), AllOf(HasSubstr("gauges.csv:1: "), HasSubstr("a header begins with name")));
  EXPECT_THAT(complaint_of_sensors(""), AllOf(HasSubstr("gauges.csv"), HasSubstr("lists no sensor"), HasSubstr("name,x,y,z")));
}

TEST(ForwardCase, ANumberIsOneParameter) {
  EXPECT_THAT(complaint(parameters + "[parameter.rho]\nkey = \"material.mercury.density\"\nmin = 13000\nmax = 14000\n"),
              AllOf(HasSubstr("parameter.rho.key"), HasSubstr("is the parameter density already")));
}

TEST(ForwardCase, AMechanismThatIsNotEnabledIsSuggested) {
  EXPECT_THAT(complaint("[parameter.alpha]\nkey = \"mechanism.bubbly_liquid.alpha0\"\nmin = 1e-6\nmax = 1e-3\n"),
              HasSubstr("set mechanism.bubbly_liquid.enabled = true"));
}

TEST(ForwardCase, ReportsWhereRunsOfTheGruneisenPolicyFail) {
  const auto of = [](double low, double high) {
    return small_case(fmt::format("[parameter.sound_speed]\nmin = {}\nmax = {}\n", low, high), "peak_pressure = 25e6\npolicy = \"gruneisen\"").notes;
  };
  EXPECT_THAT(of(1300, 1600), ::testing::Each(::testing::Not(HasSubstr("gruneisen"))));
  EXPECT_THAT(of(1000, 1600), ::testing::Contains(AllOf(HasSubstr("gruneisen"), HasSubstr("parameter.sound_speed"))));
}

TEST(ForwardCase, ReadsParametersInTheOrderOfTheFile) {
  const ForwardCase c = small_case(parameters);
  EXPECT_EQ(c.name, "small box");
  std::vector<std::string> names, keys;
  for (const auto& p : c.parameters) names.push_back(p.name), keys.push_back(p.key);
  EXPECT_THAT(names, ElementsAre("tensile_cutoff", "density", "gain", "nu"));
  EXPECT_THAT(keys, ElementsAre("material.mercury.tensile_cutoff", "material.mercury.density", "sensor.T.gain", "material.steel.poisson"));
}

TEST(ForwardCase, NominalsComeFromTheTablesUnlessGiven) {
  const ForwardCase c = small_case(parameters);
  EXPECT_EQ(*c.parameters[0].nominal, 1.5e5);
  EXPECT_EQ(*c.parameters[1].nominal, 13000);
  EXPECT_EQ(*c.parameters[2].nominal, 1);
  EXPECT_EQ(*c.parameters[3].nominal, 0.29);
}

TEST(ForwardCase, SetsAnyNumberAndLeavesTheOriginalAlone) {
  const ForwardCase c = small_case(parameters);
  const std::vector<double> theta{2e5, 12000, 1.1, 0.3};
  const ForwardCase at = c.at(theta);
  EXPECT_EQ(at.mercury.tensile_cutoff, 2e5);
  EXPECT_EQ(at.mercury.density, 12000);
  EXPECT_EQ(at.sensors[0].gain, 1.1);
  EXPECT_EQ(at.sensors[1].gain, 1);
  EXPECT_EQ(at.steel.poisson, 0.3);
  EXPECT_EQ(c.mercury.density, 13500);
  ForwardCase own = c;
  own.set_number("load.profile.center.1", 0.012);
  EXPECT_EQ(own.load.profile.center[1], 0.012);
  own.set_number("load.peak_pressure", 3e7);
  EXPECT_EQ(own.number("load.peak_pressure"), 3e7);
  EXPECT_THROW((void)c.at(std::vector<double>{1.0}), ContractFailure);
}

// A gauge's own value of a mechanism is made when it is set, not when it is requested: the provenance of a case that was only read is that of the case.
TEST(ForwardCase, ReadingANumberLeavesTheCaseAsItIs) {
  ForwardCase c = small_case("[mechanism.sensor_response]\nenabled = true\ngain = 1.05\n[mechanism.sensor_response.F]\ngain = 0.9\n");
  const Json before = c.echo();
  EXPECT_EQ(c.number("mechanism.sensor_response.T.gain"), 1.05);  // the common one answers
  EXPECT_EQ(c.number("mechanism.sensor_response.F.gain"), 0.9);
  EXPECT_EQ(c.number("mechanism.sensor_response.F.delay"), 0);
  EXPECT_THROW((void)c.number("mechanism.sensor_response.T.gian"), InputError);
  EXPECT_THROW((void)c.number("mechanism.sensor_response.G.gain"), InputError);
  EXPECT_EQ(c.echo(), before);
  // A parameter that represents one takes its nominal from the common value and is itself no value of the case.
  const ForwardCase fitted =
      small_case("[mechanism.sensor_response]\nenabled = true\ngain = 1.05\n[parameter.g]\nkey = \"mechanism.sensor_response.T.gain\"\nmin = 0.8\nmax = 1.2\n");
  EXPECT_EQ(*fitted.parameters[0].nominal, 1.05);
  EXPECT_FALSE(fitted.echo()["mechanism"]["sensor_response"].contains("T.gain"));
  // Control: setting makes it.
  c.set_number("mechanism.sensor_response.T.gain", 1.1);
  EXPECT_EQ(c.number("mechanism.sensor_response.T.gain"), 1.1);
  EXPECT_EQ(c.echo()["mechanism"]["sensor_response"]["T.gain"], 1.1);
  EXPECT_EQ(c.number("mechanism.sensor_response.gain"), 1.05);
}

TEST(ForwardCase, RefusesAParameterWhosePriorOrOwnValueLiesOutsideItsBounds) {
  const std::string bounds = "[parameter.density]\nmin = 13000\nmax = 14000\n";
  EXPECT_THAT(complaint(bounds + "prior = \"normal\"\nmean = 13.5\nsd = 1\n"),
              ::testing::AllOf(HasSubstr("parameter.density.mean = 13.5"), HasSubstr("13000 <= x <= 14000")));
  EXPECT_THAT(complaint(bounds + "prior = \"lognormal\"\nmu = 13500\nsigma = 1\n"),
              ::testing::AllOf(HasSubstr("parameter.density.mu = 13500"), HasSubstr("9.4")));
  EXPECT_EQ(complaint(bounds + "prior = \"truncated_normal\"\nmean = 12000\nsd = 1000\n"), "no error");
  EXPECT_THAT(complaint("[parameter.sound_speed]\nmin = 2000\nmax = 3000\n"),
              ::testing::AllOf(HasSubstr("1450"), HasSubstr("outside the bounds of [parameter.sound_speed]"), HasSubstr("2000 <= x <= 3000")));
}

TEST(ForwardCase, AMechanismHasNoParametersOfItsOwn) {
  EXPECT_THAT(complaint("[mechanism.wall_thinning]\nenabled = true\n[mechanism.wall_thinning.parameter.fraction]\nmin = 0\nmax = 0.5\n"),
              ::testing::AllOf(HasSubstr("mechanism.wall_thinning.parameter"), HasSubstr("[parameter.NAME] with key = \"mechanism.wall_thinning.fraction\"")));
}

TEST(ForwardCase, NamesTheNearestNumber) {
  const ForwardCase c = small_case();
  try {
    (void)c.number("material.mercury.densty");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("did you mean \"material.mercury.density\"?"));
  }
  EXPECT_THROW((void)c.number("load.energy"), InputError);  // there, but without a value
}

TEST(ForwardCase, ErrorsSayWhereAndWhat) {
  EXPECT_THAT(complaint("[parameter.colour]\nmin = 0\nmax = 1\n"), HasSubstr("parameter.colour"));
  EXPECT_THAT(complaint("[parameter.density]\nmin = 2\nmax = 1\n"), HasSubstr("case.toml:"));
  EXPECT_THAT(complaint("[parameter.density]\nmin = 1\nmax = 2\n"), HasSubstr("nominal"));  // 13500 lies outside
  EXPECT_THAT(complaint("[[sensor]]\nname = \"T\"\nposition = [0.03, 0, 0.03]\ndirection = [1, 0, 0]\n"), HasSubstr("two sensors have the same name"));
  EXPECT_THAT(complaint("[solver]\nprecission = \"single\"\n"), HasSubstr("precision"));
  EXPECT_THAT(complaint("[material.steel]\npoisson = 0.6\n"), HasSubstr("material.steel.poisson = 0.6"));
  EXPECT_THAT(complaint("[[condition]]\nname = \"low\"\n"), HasSubstr("either peak_pressure or energy"));
}

TEST(ForwardCase, AnEndThatIsNoMultipleOfTheIntervalIsRefused) {
  TimeOptions t;
  t.end = 1.05e-5;
  t.output_interval = 1e-6;
  EXPECT_THROW(t.validate(), InputError);
  t.end = 1e-5;
  EXPECT_NO_THROW(t.validate());
  EXPECT_EQ(t.samples(), 11u);
}

TEST(ForwardCase, EchoesEveryTable) {
  const Json j = small_case(parameters).echo();
  EXPECT_EQ(j["material"]["mercury"]["density"], 13500.0);
  EXPECT_EQ(j["load"]["profile"]["center"][1], 0.015);
  EXPECT_EQ(j["sensor"].size(), 2u);
  EXPECT_EQ(j["parameter"]["gain"]["key"], "sensor.T.gain");
}
