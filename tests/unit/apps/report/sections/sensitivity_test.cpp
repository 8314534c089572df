#include "apps/report/sections/sensitivity.hpp"

#include <gmock/gmock.h>

#include <string>

#include "apps/report/data/study.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/unit/apps/report/reading.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::HasSubstr;
using testing::Not;

TEST(ReportSensitivity, WithoutOneNamesTheCommand) {
  const auto dir = scratch("no_sensitivity");
  write_study(dir, input());
  EXPECT_THAT(report_of(dir, input()),
              HasSubstr("No sensitivity has been computed (sensitivity.json). Compute it with <code>calomel sensitivity slice.toml</code>."));
  EXPECT_TRUE(sensitivity_drawings(read_study(dir), input()).is_null());
}

TEST(ReportSensitivity, NamesTheParametersThatMatterMostThoseThatHardlyMatterAndTheirBounds) {
  const auto dir = scratch("sensitivity_words");
  write_sensitivity(dir, input());  // no other artefact
  const std::string text = markup(report_of(dir, input()));
  EXPECT_THAT(text, HasSubstr("<strong>sound_speed</strong> has a part in 70\u00a0% (69\u00a0% to 71\u00a0%), density in 40\u00a0% (39\u00a0% to 41\u00a0%) "
                              "and tensile_cutoff in 0.5\u00a0%"));
  EXPECT_THAT(text, HasSubstr("Alone, the parameters cause 90\u00a0% of the variation; the rest is due to interactions."));
  EXPECT_THAT(text, HasSubstr("tensile_cutoff hardly matters within these bounds: these records contain almost no information on it."));
  EXPECT_THAT(text, HasSubstr("density 5000 to 20\u202f000\u00a0kg/m\u00b3"));
  EXPECT_THAT(text, HasSubstr("follows 18 of the 18 numbers (left-out R\u00b2 above 0.9); there its total indices differ from these by 0.03 at most."));
  EXPECT_THAT(text, HasSubstr("16 failed and were left out"));
  EXPECT_THAT(text, Not(HasSubstr("is not settled")));  // no intervals overlap
  EXPECT_THAT(text, HasSubstr("href=\"#sensitivity\""));
}

TEST(ReportSensitivity, ParametersWhoseIntervalsOverlapAreNotRanked) {
  const auto dir = scratch("sensitivity_tied");
  write_sensitivity(dir, input());
  Json json = read_json(dir / "sensitivity.json");
  json["total_order"][1]["high"] = 0.695;
  write_json(dir / "sensitivity.json", json);
  EXPECT_THAT(markup(report_of(dir, input())), HasSubstr("not settled: sound_speed and density."));
}

TEST(ReportSensitivity, MapIsWeightedByVarianceAndSilentWhereNothingVaries) {
  const auto dir = scratch("sensitivity_map");
  const auto in = input();
  write_sensitivity(dir, in);
  const Json data = data_of(report_of(dir, in))["sensitivity"];
  EXPECT_EQ(data["parameters"], Json({"tensile_cutoff", "density", "sound_speed"}));
  ASSERT_EQ(data["rows"].size(), in.sensors.size());
  EXPECT_EQ(data["rows"].back(), hostile);
  const Json &map = data["map"], &curves = data["curves"];
  for (std::size_t w = 0; w < map["begin"].size(); ++w) {
    const double begin = map["begin"][w], end = map["end"][w];
    const Json density = map["total"][1][2][w], speed = map["total"][2][2][w];
    if (end < 9.5) {
      EXPECT_TRUE(density.is_null() && speed.is_null()) << end;  // at rest
    } else if (begin > 9.5 && end < 99.5) {
      EXPECT_EQ(density, 1) << begin;
      EXPECT_EQ(speed, 0) << begin;
    } else if (begin > 99.5) {
      EXPECT_EQ(density, 0) << begin;
      EXPECT_EQ(speed, 1) << begin;
    } else {
      EXPECT_NEAR(density.get<double>() + speed.get<double>(), 1, 1e-3) << begin;
    }
  }
  EXPECT_EQ(curves["first"][1][0][50], 0.9);
  EXPECT_EQ(curves["sd"][1][200], 20);  // microstrain
  ASSERT_EQ(data["morris"].size(), 3u);
  EXPECT_EQ(data["morris"][1]["unit"], "\u00b5s");
  EXPECT_EQ(data["morris"][0]["points"].size(), 3 * in.sensors.size());
}

TEST(ReportSensitivity, CurvesOfAnotherAnalysisAreNotShown) {
  const auto dir = scratch("sensitivity_other");
  write_sensitivity(dir, input());
  Json json = read_json(dir / "sensitivity.json");
  json["provenance"]["identity"] = "another";
  write_json(dir / "sensitivity.json", json);
  const std::string page = report_of(dir, input());
  EXPECT_THAT(markup(page), HasSubstr("sensitivity.nc is missing or belongs to another analysis"));
  EXPECT_TRUE(data_of(page)["sensitivity"]["map"].is_null());
}
