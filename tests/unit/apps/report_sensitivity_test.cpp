#include <gmock/gmock.h>

#include "apps/report/page.hpp"
#include "apps/report/sensitivity.hpp"
#include "tests/unit/apps/report_reading.hpp"
#include "tests/unit/apps/report_study.hpp"

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

TEST(ReportSensitivity, TellsWhatMattersMostWhatHardlyMattersAndWithinWhichBounds) {
  const auto dir = scratch("sensitivity_words");
  write_sensitivity(dir, input());  // nothing else is there
  const std::string text = markup(report_of(dir, input()));
  EXPECT_THAT(text, HasSubstr("<strong>sound_speed</strong> has a part in 70\u00a0% (69\u00a0% to 71\u00a0%), density in 40\u00a0% (39\u00a0% to 41\u00a0%) "
                              "and tensile_cutoff in 0.5\u00a0%"));
  EXPECT_THAT(text, HasSubstr("Alone, the parameters make 90\u00a0% of the variation; the rest is what they do together."));
  EXPECT_THAT(text, HasSubstr("tensile_cutoff hardly matters within these bounds: these records say next to nothing of it."));
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

TEST(ReportSensitivity, TablesHoldTheNumbersOfTheSummary) {
  const auto dir = scratch("sensitivity_tables");
  const auto in = input();
  write_sensitivity(dir, in);
  const Study study = read_study(dir);
  const Table by_record = total_order_table(study, "record");
  ASSERT_EQ(by_record.rows.size(), in.sensors.size() + 1);
  EXPECT_EQ(std::get<std::string>(by_record.rows[0][3].value), "0.65 (0.64 to 0.66)");
  EXPECT_TRUE(by_record.rows[0][3].strong);
  EXPECT_FALSE(by_record.rows[0][2].strong);
  EXPECT_EQ(std::get<std::string>(by_record.rows.back()[0].value), "all records");
  write_tables_csv(dir, in);
  const auto csv = csv_of(dir / "report_csv" / "sensitivity.csv");
  ASSERT_EQ(csv.size(), 1 + 3 * (in.sensors.size() + 1));
  EXPECT_EQ(csv[1][0], "all records");
  EXPECT_EQ(number_in(csv, 3, "first_order"), -0.02);  // of gauge B: below 0 and not clipped
  const auto effects = csv_of(dir / "report_csv" / "sensitivity_morris.csv");
  ASSERT_EQ(effects.size(), 1 + 9 * in.sensors.size());
  EXPECT_NEAR(number_in(effects, 1, "mu_star"), 20, 1e-9);  // microstrain
  EXPECT_NEAR(number_in(effects, 4, "mu_star"), 1, 1e-9);   // microseconds
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

namespace {

/// The analysis of the other tests with dissipated energy, of which the shares are known, and a time at the cutoff that does not vary.
void write_totals(const std::filesystem::path& dir) {
  write_sensitivity(dir, input());
  Json json = read_json(dir / "sensitivity.json");
  Json energy = json["quantities"][0], time = energy;
  energy["name"] = "dissipated_energy", energy["sensor"] = "", energy["unit"] = "J", energy["mean"] = 0.25, energy["sd"] = 0.05;
  energy["source"] = "a polynomial of order 3 fitted to 60 runs at pulse energy 1", energy["left_out_r2"] = 0.42,
  energy["note"] = "the polynomial does not follow <the runs>";
  energy["polynomial"]["left_out_r2"] = 0.42;
  for (auto& e : energy["morris"]) e["mu_star"] = 0.125;
  time["name"] = "time_at_cutoff", time["sensor"] = "", time["unit"] = "s", time["note"] = "it is 0 s in all 60 runs: it does not vary";
  time.erase("polynomial");
  for (auto& i : time["total_order"]) i["value"] = i["low"] = i["high"] = nullptr;
  for (auto& e : time["morris"]) e["mu_star"] = e["sigma"] = e["mu"] = 0.0;
  const Json whole = json["quantities"].back();
  json["quantities"].back() = energy, json["quantities"].push_back(time), json["quantities"].push_back(whole);
  write_json(dir / "sensitivity.json", json);
}

}  // namespace

TEST(ReportSensitivity, TotalsOfTheRunAreToldWithTheirPolynomialAndWhyThereAreNone) {
  const auto dir = scratch("sensitivity_totals");
  write_totals(dir);
  const std::string page = report_of(dir, input()), text = markup(page);
  EXPECT_THAT(text, HasSubstr("<strong>dissipated energy</strong>: 0.25\u00a0J in the mean, with a standard deviation of 0.05\u00a0J. Its shares are those of "
                              "a polynomial of order 3 fitted to 60 runs at pulse energy 1, left-out "
                              "R\u00b2 0.420. <strong>the polynomial does not follow &lt;the runs&gt;.</strong>"));
  EXPECT_THAT(text, HasSubstr("<strong>time at the cutoff</strong>: it is 0 s in all 60 runs: it does not vary.</p>"));
  EXPECT_THAT(text, HasSubstr("Total index of each parameter for the dissipated energy"));
  EXPECT_THAT(text, Not(HasSubstr("Total index of each parameter for the time at the cutoff")));
  EXPECT_THAT(text, HasSubstr("follows 18 of the 18 numbers")) << "a total's polynomial is no check of a surrogate";
  EXPECT_THAT(text, HasSubstr("<strong>sound_speed</strong> has a part in 70\u00a0%")) << "all records together stay what they are";
  const Table effects = morris_table(read_study(dir), input());
  const auto energy =
      std::find_if(effects.rows.begin(), effects.rows.end(), [](const auto& row) { return std::get<std::string>(row[0].value) == "dissipated energy"; });
  ASSERT_NE(energy, effects.rows.end());
  EXPECT_EQ(std::get<std::string>((*energy)[1].value), "the run");
  EXPECT_EQ(std::get<std::string>((*energy)[2].value), "J");
  EXPECT_EQ(std::get<double>((*energy)[5].value), 0.125) << "in joules";
  const Json drawn = data_of(page)["sensitivity"]["morris"];
  ASSERT_EQ(drawn.size(), 4u);
  EXPECT_EQ(drawn[3]["title"], "dissipated energy");
  EXPECT_EQ(drawn[3]["unit"], "J");
  EXPECT_EQ(drawn[3]["points"][0]["mu_star"], 0.125);
}

TEST(ReportSensitivity, WithoutTotalsNothingIsSaidOfThem) {
  const auto dir = scratch("sensitivity_no_totals");
  write_sensitivity(dir, input());
  EXPECT_THAT(markup(report_of(dir, input())), Not(HasSubstr("Dissipated energy")));
}
