#include "apps/report/sections/header.hpp"

#include <gmock/gmock.h>

#include <string>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/unit/apps/report/reading.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::HasSubstr;
using testing::Not;

TEST(Report, GivesTheResultInPlainWords) {
  const auto dir = scratch("words");
  const auto in = input();
  write_study(dir, in);
  const std::string text = markup(report_of(dir, in));
  EXPECT_THAT(text, HasSubstr("inside the measured band <strong>74.8\u00a0%</strong> of the time (nominal 70.5\u00a0%)"));
  EXPECT_THAT(text, HasSubstr("<strong>17.1\u00a0\u00b5\u03b5</strong> (nominal 18.8\u00a0\u00b5\u03b5)"));
  EXPECT_THAT(text, HasSubstr("Both are better than with the nominal values."));
  EXPECT_THAT(text, HasSubstr("not a material property"));
  EXPECT_THAT(text, HasSubstr("the best round lies on the bound of tensile_cutoff"));
  EXPECT_THAT(text, HasSubstr("does not follow the parameters"));
}

TEST(Report, AWarningOfSeveralMethodsIsShownOnceWithAllOfThem) {
  const auto dir = scratch("warned_twice");
  const auto in = input();
  write_study(dir, in);
  write_calibration(dir, in, "map");
  Json map = read_json(dir / "map.json");
  map["warnings"].push_back("a bound of density lies near");
  write_json(dir / "map.json", map);
  const std::string text = markup(report_of(dir, in));
  EXPECT_THAT(text, HasSubstr("<li>ENC, MAP: the best round lies on the bound of tensile_cutoff</li>"));
  EXPECT_THAT(text, HasSubstr("<li>MAP: a bound of density lies near</li>"));
}

TEST(Report, DoesNotPraiseACalibrationThatIsNoBetter) {
  const auto dir = scratch("worse");
  const auto in = input();
  write_study(dir, in);
  Json enc = read_json(dir / "enc.json");
  enc["accuracy"] = 60.0;
  enc["mae"] = 30.0;
  write_json(dir / "enc.json", enc);
  const std::string text = markup(report_of(dir, in));
  EXPECT_THAT(text, HasSubstr("Neither is better than with the nominal values."));
  EXPECT_THAT(text, Not(HasSubstr("Both are better")));
}
