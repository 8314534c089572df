#include "forward/line/line_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/forward/line/line_cases.hpp"

namespace calomel {
namespace {

using namespace testing;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string error_of(const std::string& text) {
  try {
    (void)line_case(text);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

std::vector<double> values(const LineModel& model, const std::map<std::string, double>& numbers = {}) {
  const auto theta = nominal(model.shape());
  const auto p = model.evaluate(theta, numbers);
  EXPECT_TRUE(p.ok) << p.message;
  return p.mean;
}

TEST(LineModel, OfABarDelaysAndScalesTheRecord) {
  const LineModel model(line_case(bar_text()));
  EXPECT_THAT(model.shape().sensors, ElementsAre("near", "far"));
  EXPECT_EQ(model.shape().unit, "strain");
  const auto y = values(model);
  for (std::size_t i = 0; i < model.shape().times.size(); ++i) {
    const double t = model.shape().times[i];
    const auto pulse = [](double s) {
      const double x = (s - 20e-6) / 30e-6;
      return x > 0 && x < 1 ? 0.5e-3 * (1 - std::cos(2 * M_PI * x)) : 0;
    };
    ASSERT_NEAR(y[model.shape().at(0, 0, i)], pulse(t - 50e-6), 1e-8);  // the file's six digits
    ASSERT_NEAR(y[model.shape().at(0, 1, i)], 2 * pulse(t - 200e-6), 1e-8);
  }
}

TEST(LineModel, OfAPipeShowsJoukowskysPressureAndThePeriodExactly) {
  const LineModel model(line_case(pipe_text("", "viscosity = 0\nfriction_factor = 0\n")));
  const auto y = values(model);
  const double rise = 1000 * 1250 * 0.5 / 1e3;  // 625 kPa
  for (std::size_t i = 1; i < model.shape().times.size(); ++i) {
    const double t = model.shape().times[i], phase = std::fmod(t, 0.128);                                            // 4 L / a
    if (std::abs(phase) < 0.0011 || std::abs(phase - 0.064) < 0.0011 || std::abs(phase - 0.128) < 0.0011) continue;  // a step of the grid at the fronts
    ASSERT_NEAR(y[i], 200 + (phase < 0.064 ? rise : -rise), 1e-9) << t;
  }
}

TEST(LineModel, EveryMechanismAtItsOffValuesIsTheBaseModelByteForByte) {
  for (const std::string& text : {bar_text(), pipe_text("", "friction_factor = 0.02")}) {
    const LineModel base(line_case(text));
    const auto plain = values(base);
    const auto offered = base.offered();
    EXPECT_EQ(offered.size(), base.line_case().mechanisms.size());
    for (const auto& m : offered) {
      std::map<std::string, double> off;
      for (const auto& k : m.keys) {
        const std::string key = "mechanism." + m.name + '.' + k.name;
        off[key] = k.decides ? k.off : k.low;
        if (!k.decides) continue;
        const double moved = std::isfinite(k.off) && k.low == k.off ? k.high
                             : k.log_uniform                        ? std::sqrt(k.low * k.high)
                                                                    : k.low + 0.5 * (k.high - k.low) * (0.5 * (k.low + k.high) == k.off ? 0.5 : 1);
        EXPECT_NE(values(base, {{key, moved}}), plain) << key << " = " << moved;
      }
      EXPECT_EQ(values(base, off), plain) << m.name;
      std::string enabled = "[mechanism." + m.name + "]\nenabled = true\n";
      EXPECT_EQ(values(LineModel(line_case(text + enabled))), plain) << m.name;
    }
  }
}

TEST(LineModel, AMechanismOfTheCaseIsWhatSettingItsNumbersIs) {
  const LineModel base(line_case(bar_text()));
  const LineModel with(line_case(bar_text("[mechanism.lateral_inertia]\nenabled = true\npoisson = 0.3\n")));
  EXPECT_EQ(values(with), values(base, {{"mechanism.lateral_inertia.poisson", 0.3}}));
  EXPECT_NE(values(with), values(base));
  // Listed, not enabled: offered, not part of the model.
  const LineModel listed(line_case(bar_text("[mechanism.lateral_inertia]\npoisson = 0.3\n")));
  EXPECT_EQ(values(listed), values(base));
}

TEST(LineModel, OneStationsChannelLeavesTheOthers) {
  const LineModel model(line_case(bar_text()));
  const auto plain = values(model), one = values(model, {{"mechanism.sensor_response.far.lag", 3e-6}});
  const std::size_t n = model.shape().times.size();
  EXPECT_TRUE(std::equal(plain.begin(), plain.begin() + std::ptrdiff_t(n), one.begin()));
  EXPECT_FALSE(std::equal(plain.begin() + std::ptrdiff_t(n), plain.end(), one.begin() + std::ptrdiff_t(n)));
}

TEST(LineModel, ParametersAreAnyNumberOfTheCase) {
  const LineModel model(line_case(bar_text(R"([parameter.wave_speed]
min = 4500
max = 5500
[parameter.clock]
key = "station.far.delay"
min = -1e-5
max = 1e-5
[parameter.nu]
key = "mechanism.lateral_inertia.poisson"
min = 0
max = 0.4
[mechanism.lateral_inertia]
enabled = true
poisson = 0.25
)")));
  const auto& p = model.shape().parameters;
  ASSERT_EQ(p.size(), 3u);
  EXPECT_EQ(p[0].key, "line.wave_speed");
  EXPECT_EQ(*p[0].nominal, 5000);
  EXPECT_EQ(*p[2].nominal, 0.25);
  const auto a = model.evaluate(std::vector<double>{5000, 2e-6, 0.25});
  const auto b = model.evaluate(std::vector<double>{5000, 0, 0.25}, {{"station.far.delay", 2e-6}});
  EXPECT_EQ(a.mean, b.mean);
  const auto failed = model.evaluate(std::vector<double>{0, 0, 0.25});
  EXPECT_FALSE(failed.ok);
  EXPECT_THAT(failed.message, HasSubstr("wave speed"));
  EXPECT_THROW((void)model.evaluate(std::vector<double>{5000, 0, 0.25}, {{"mechanism.lateral_inertia.poison", 0.3}}), InputError);
}

TEST(LineModel, LateralInertiaIsOfferedWhereTheRadiusIsKnown) {
  const LineModel model(line_case(bar_text("", "")));
  std::vector<std::string> names;
  for (const auto& m : model.offered()) names.push_back(m.name);
  EXPECT_THAT(names, ElementsAre("viscous_attenuation", "sensor_response"));
  EXPECT_THAT(error_of(bar_text("[mechanism.lateral_inertia]\nenabled = true\npoisson = 0.3\n", "")), HasSubstr("needs line.radius"));
}

TEST(LineCase, ReportsPlaceValueAndSuggestionOfAMistake) {
  EXPECT_THAT(error_of("[model]\nkind = \"line\"\n"), HasSubstr("the table [line] is missing"));
  EXPECT_THAT(error_of("[model]\nkind = \"line\"\n[line]\nkind = \"bare\"\n"), HasSubstr("case.toml:4:1: line.kind = \"bare\""));
  EXPECT_THAT(error_of(bar_text("", "radus = 0.01")), HasSubstr("did you mean \"radius\"?"));
  EXPECT_THAT(error_of(bar_text("", "cells = 10")), HasSubstr("line.cells = 10: unknown key"));
  EXPECT_THAT(error_of(bar_text("", "radius = -0.01")), HasSubstr("line.radius"));
  EXPECT_THAT(error_of(bar_text("[mechanism.vapour_cutoff]\n")), HasSubstr("mechanism.vapour_cutoff: no mechanism of a bar of this name"));
  EXPECT_THAT(error_of(pipe_text("[mechanism.vapour_cutoff]\npresure = 1\n")), HasSubstr("did you mean \"pressure\"?"));
  EXPECT_THAT(error_of(pipe_text("[[station]]\nname = \"out\"\ndistance = 41\n")),
              HasSubstr("station[2].distance = 41: a station of a pipe lies on it (allowed: 0 to 40 m)"));
  EXPECT_THAT(error_of(pipe_text("[[station]]\nname = \"valve\"\ndistance = 1\n")), HasSubstr("two stations have the same name"));
  EXPECT_THAT(error_of(pipe_text("[parameter.x]\nkey = \"line.frction_factor\"\nmin = 0\nmax = 1\n")), HasSubstr("did you mean \"line.friction_factor\"?"));
  EXPECT_THAT(error_of(pipe_text("[parameter.pv]\nkey = \"mechanism.vapour_cutoff.pressure\"\nmin = -1e5\nmax = 0\n")), HasSubstr("not part of the model"));
}

TEST(LineCase, BarsRecordMustReachTheEnd) {
  auto text = bar_text();
  text.replace(text.find("end = 400e-6"), 12, "end = 800e-6");
  EXPECT_THAT(error_of(text), HasSubstr("does not reach that far"));
}

}  // namespace
}  // namespace calomel
