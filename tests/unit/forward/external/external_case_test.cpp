#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "base/json.hpp"
#include "forward/external/external_case.hpp"

namespace calomel {
namespace {

const std::string head = R"([case]
name = "x"
[model]
kind = "umbridge"
url = "http://127.0.0.1:1"
name = "m"
config = { level = 2, word = "fine", list = [1, 2.5] }
)";
const std::string bare = head.substr(0, head.find("config"));  ///< without a config
const std::string output = R"([output]
sensors = ["B", "A"]
time = { start = 1.0, step = 0.5, count = 3 }
)";
const std::string parameters = R"([parameter.zeta]
min = 0.0
max = 4.0
[parameter.alpha]
min = 1.0
max = 9.0
prior = "lognormal"
mu = 1.0
sigma = 0.2
[mechanism.second.parameter.z]
off = 0.0
min = 0.1
max = 2.0
prior = "half_cauchy"
scale = 0.2
[mechanism.second.parameter.a]
off = 1.0
min = 0.0
max = 2.0
[mechanism.first.parameter.p]
off = 0.0
min = -1.0
max = 1.0
)";

ExternalCase read(const std::string& text) {
  auto file = CaseFile::from_text(text);
  return ExternalCase::read(file);
}

std::string refusal(const std::string& text) {
  try {
    (void)read(text);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(ExternalCase, InputsAreInTheOrderOfTheFile) {
  const auto c = read(head + output + parameters);
  ASSERT_EQ(c.parameters.size(), 2u);
  EXPECT_EQ(c.parameters[0].name, "zeta");
  EXPECT_EQ(*c.parameters[0].nominal, 2.0);
  EXPECT_NEAR(*c.parameters[1].nominal, std::exp(1.0), 1e-12);
  ASSERT_EQ(c.mechanisms.size(), 2u);
  EXPECT_EQ(c.mechanisms[0].name, "second");
  EXPECT_EQ(c.mechanisms[0].parameters[0].key, "mechanism.second.parameter.z");
  EXPECT_EQ(c.mechanisms[0].parameters[0].min, 0.0) << "the bounds reach to the off value";
  EXPECT_EQ(c.inputs(), 5u);
  EXPECT_EQ(c.output.sensors, (std::vector<std::string>{"B", "A"}));
  EXPECT_EQ(c.server.config, (Json{{"level", 2}, {"list", {1, 2.5}}, {"word", "fine"}}));
  const auto groups = offered_groups(c);
  ASSERT_EQ(groups.size(), 4u);
  EXPECT_EQ(groups[0].added.size(), 2u);
  EXPECT_EQ(*groups[0].added[1].parameter.nominal, 1.0);
  for (const double s : groups[1].added[0].strengths) EXPECT_NE(s, 0.0);
  // And the response of each gauge.
  EXPECT_EQ(groups[2].name, "sensor_response");
  EXPECT_EQ(groups[2].sensor, "B");
  EXPECT_EQ(groups[3].sensor, "A");
  EXPECT_EQ(groups[3].added[0].parameter.key, "sensor_response.gain.A");
  EXPECT_EQ(*groups[3].added[0].parameter.nominal, 1.0);
}

TEST(ExternalCase, AnEnabledMechanismIsPartOfTheModel) {
  const auto c = read(head + output + parameters + "[mechanism.first]\nenabled = true\n");
  ASSERT_EQ(c.parameters.size(), 3u);
  EXPECT_EQ(c.parameters[2].name, "first.p");
  EXPECT_EQ(offered_groups(c).size(), 3u);
}

TEST(ExternalCase, TheResponseOfGaugesIsNotOfferedBesideOneOfTheCaseNorForOneSensor) {
  const std::string own = "[mechanism.sensor_response.parameter.q]\noff = 0.0\nmin = 0.0\nmax = 1.0\n";
  EXPECT_EQ(offered_groups(read(head + output + parameters + own)).size(), 3u);
  EXPECT_EQ(offered_groups(read(head + "[output]\nsensors = [\"A\"]\ntime = { step = 0.5, count = 3 }\n" + parameters)).size(), 2u);
}

TEST(ExternalCase, MistakesAreReportedWithTheirPlace) {
  EXPECT_NE(refusal(head + parameters).find("[output]"), std::string::npos);
  EXPECT_NE(refusal(head + "[output]\nsensors = [\"A\"]\n" + parameters).find("times"), std::string::npos);
  EXPECT_NE(refusal(head + "[output]\nsensors = [\"A\", \"A\"]\ntime = { step = 1.0, count = 2 }\n" + parameters).find("same name"), std::string::npos);
  EXPECT_NE(refusal(head + output).find("no parameter"), std::string::npos);
  EXPECT_NE(refusal(head + output + parameters + "[mechanism.none]\nenabled = false\n").find("mechanism.none"), std::string::npos);
  EXPECT_NE(refusal(head + output + parameters + "[mechanism.third.parameter.q]\nmin = 0.0\nmax = 1.0\n").find("off"), std::string::npos);
  EXPECT_NE(refusal(head + "[output]\nkind = \"log_density\"\nsensors = [\"A\"]\n" + parameters).find("output.sensors"), std::string::npos);
  EXPECT_NE(refusal(head + output + "[parameter.a]\nkey = \"line.x\"\nmin = 0.0\nmax = 1.0\n").find("key"), std::string::npos);
  EXPECT_NE(refusal(head + output + "[parameter.\"c.d\"]\nmin = 0.0\nmax = 1.0\n").find("c.d"), std::string::npos);
  EXPECT_NE(refusal(head + output + parameters + "[mechanism.third.parameter.q]\noff = 0.0\nmin = 0.5\nmax = 0.1\n").find("mechanism.third.parameter.q.max"),
            std::string::npos);
  for (const char* config : {"3", "[1, 2]", "\"x\""})
    EXPECT_NE(refusal(bare + "config = " + config + "\n" + output + parameters).find("a table"), std::string::npos) << config;
  for (const char* value : {"nan", "inf", "1979-05-27"})
    EXPECT_NE(refusal(bare + "config = { a = { b = " + value + " } }\n" + output + parameters).find("model.config.a.b"), std::string::npos) << value;
}

// Runs hang on what the model is asked, not on where it is, nor on what is thought of its inputs.
TEST(ExternalCase, RunsAreThoseOfTheModelWhereverItIs) {
  const std::string group = "[mechanism.third.parameter.q]\noff = 0.0\nmin = 0.0\nmax = 1.0\n";
  const auto options = [&](const std::string& text) { return read(text).model_options(); };
  const Json usual = options(head + output + parameters + group);
  EXPECT_FALSE(usual["model"].contains("url"));
  EXPECT_EQ(usual["inputs"].back(), "mechanism.third.parameter.q");
  EXPECT_EQ(options(head + output + parameters + "[mechanism.third.parameter.q]\noff = 0.0\nmin = 0.0\nmax = 3.0\nprior = \"half_cauchy\"\nscale = 1.0\n"),
            usual);
  EXPECT_NE(options(head + output + parameters + "[mechanism.third.parameter.q]\noff = 0.1\nmin = 0.0\nmax = 1.0\n"), usual);
  EXPECT_NE(options(bare + "config = { level = 3 }\n" + output + parameters + group), usual);
  EXPECT_EQ(read(head + output + parameters + group).echo()["mechanism"]["third"]["parameter"].begin().key(), "q");
}

}  // namespace
}  // namespace calomel
