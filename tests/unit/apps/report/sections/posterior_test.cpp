#include "apps/report/sections/posterior.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <variant>

#include "apps/report/data/study.hpp"
#include "apps/report/report.hpp"
#include "apps/report/sections/corner.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/unit/apps/report/reading.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::HasSubstr;
using testing::Not;

TEST(ReportPosterior, WithoutDrawsNamesTheCommand) {
  const auto dir = scratch("no_posterior");
  write_study(dir, input());
  write_report(dir, input());
  EXPECT_THAT(read_text(dir / "report.html"),
              HasSubstr("No posterior has been sampled (posterior.nc, posterior.json). Sample it with <code>calomel sample slice.toml</code>."));
  EXPECT_TRUE(corner_json(read_study(dir), input(), 100).is_null());
}

TEST(ReportPosterior, TableHoldsTheNumbersOfTheSummary) {
  const auto dir = scratch("posterior_table");
  const auto in = input();
  write_sample(dir, ridge_draws());
  write_report(dir, in);
  const std::string page = read_text(dir / "report.html");
  EXPECT_THAT(page, HasSubstr("The chains have converged"));
  EXPECT_THAT(page, HasSubstr("By the <a href=\"#posterior\">posterior</a>: tensile_cutoff <strong>"));
  EXPECT_THAT(page, Not(HasSubstr("gain_B <strong>")));  // only the case's own parameters
  EXPECT_THAT(page, Not(HasSubstr("No calibration has been run yet, so this page shows")));
  EXPECT_THAT(page, HasSubstr("density [kg/m\u00b3]"));
  EXPECT_THAT(page, HasSubstr("id=\"corner-plot\""));
  EXPECT_THAT(page, HasSubstr("4 chains of 2000 draws"));
  const Table t = posterior_table(read_study(dir), in);
  ASSERT_EQ(t.rows.size(), 4u);
  const Json json = read_json(dir / "posterior.json");
  EXPECT_EQ(std::get<double>(t.rows[1][1].value), json["parameters"][1]["mean"].get<double>());
}

TEST(ReportPosterior, ChainsThatDisagreeAreReportedFirst) {
  const auto dir = scratch("posterior_apart");
  write_sample(dir, ridge_draws(true));
  write_report(dir, input());
  const std::string page = read_text(dir / "report.html");
  EXPECT_THAT(page, HasSubstr("Not converged, not to be trusted:"));
  EXPECT_THAT(page, HasSubstr("<strong>The posterior is not to be trusted</strong>"));
  EXPECT_THAT(page, Not(HasSubstr("By the <a href")));
  EXPECT_THAT(page, HasSubstr("<li>sampling: "));
  EXPECT_THAT(page, HasSubstr("chain 4"));
}

TEST(ReportPosterior, CsvHoldsEveryDraw) {
  const auto dir = scratch("posterior_csv");
  const auto draws = ridge_draws();
  write_sample(dir, draws);
  const auto paths = write_tables_csv(dir, input());
  const std::string csv = read_text(dir / "report_csv" / "posterior_draws.csv");
  EXPECT_THAT(csv, testing::StartsWith("chain,draw,tensile_cutoff,density,sound_speed,gain_B\n0,0,"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 8001);
  EXPECT_TRUE(std::filesystem::exists(dir / "report_csv" / "posterior.csv"));
}

TEST(ReportPosterior, AParameterThatAbsorbsSomethingIsReportedAtTheTopAndInItsSection) {
  const auto dir = scratch("posterior_absorbed");
  write_sample(dir, ridge_draws());
  Json json = read_json(dir / "posterior.json");
  json["absorption"] = {"density is 2.4 prior standard deviations below its prior mean: it compensates for an omitted effect"};
  write_json(dir / "posterior.json", json);
  const std::string text = markup(report_of(dir, input()));
  EXPECT_THAT(text, HasSubstr("<li>sampling: density is 2.4 prior standard deviations below"));
  EXPECT_THAT(
      text,
      HasSubstr(
          "<strong>density is 2.4 prior standard deviations below its prior mean: it compensates for an omitted effect.</strong>"));
  EXPECT_THAT(text, HasSubstr("<code>calomel diagnose slice.toml</code> investigates which effect is omitted."));
  EXPECT_THAT(text, Not(HasSubstr("none differs by more than")));
}

TEST(ReportPosterior, AFitThatTheRecordsContradictIsReportedAndItsNumbersAreNotFinal) {
  const auto dir = scratch("posterior_inadequate");
  write_sample(dir, ridge_draws());
  Json json = read_json(dir / "posterior.json");
  json["final"] = false;
  json["adequate"] = false;
  json["adequacy"] = "the fit is not adequate: chi-squared 369 for 80 values";
  json["warnings"] = {json["adequacy"]};
  write_json(dir / "posterior.json", json);
  const std::string page = markup(report_of(dir, input()));
  EXPECT_THAT(page, HasSubstr("<strong>By chi-squared, the fit is not adequate: chi-squared 369 for 80 values.</strong>"));
  EXPECT_THAT(page, HasSubstr("<li>sampling: the fit is not adequate"));
  EXPECT_THAT(page, HasSubstr("<strong>Not final</strong>: see the warnings."));
  json["final"] = true;
  json["adequate"] = true;
  json["adequacy"] = "the records do not contradict the fit: chi-squared 33 for 80 values";
  json["warnings"] = Json::array();
  write_json(dir / "posterior.json", json);
  const std::string fits = markup(report_of(dir, input()));
  EXPECT_THAT(fits, HasSubstr("<p>By chi-squared, the records do not contradict the fit: chi-squared 33 for 80 values.</p>"));
  EXPECT_THAT(fits, Not(HasSubstr("Not final")));
}
