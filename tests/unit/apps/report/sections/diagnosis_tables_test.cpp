#include "apps/report/sections/diagnosis_tables.hpp"

#include <gmock/gmock.h>

#include <string>
#include <variant>
#include <vector>

#include "apps/report/sections/diagnosis.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/unit/apps/report/reading.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST(ReportDiagnosis, GaugesAreListedByMismatchAndMoreThanChanceIsBold) {
  const auto dir = scratch("gauges");
  const Table named = mismatch_table(diagnosed(dir, "named"));
  ASSERT_EQ(named.rows.size(), 6u);
  EXPECT_DOUBLE_EQ(value_of(named.rows[2][1]), 5);  // the root of the score 25
  EXPECT_TRUE(named.rows[2][1].strong);
  EXPECT_EQ(text_of(named.rows[2][3]), "yes");
  EXPECT_FALSE(named.rows[0][1].strong);
  EXPECT_EQ(text_of(named.rows[0][3]), "no");
  EXPECT_DOUBLE_EQ(value_of(named.rows[2][5]), 0.06);
  // Without a named explanation there are no misfits after it.
  const Table none = mismatch_table(diagnosed(dir, "none"));
  EXPECT_TRUE(std::holds_alternative<std::monostate>(none.rows[2][5].value));
  const Table map = mismatch_map_table(read_study(dir)), bands = band_table(read_study(dir));
  EXPECT_EQ(map.rows.size(), 6u * 8 + 8);
  EXPECT_TRUE(map.rows[2 * 8 + 2][3].strong && !map.rows[2 * 8 + 1][3].strong);
  EXPECT_DOUBLE_EQ(value_of(map.rows[2 * 8 + 2][1]), 1e-4);
  EXPECT_TRUE(bands.rows[2 * 6][3].strong && !bands.rows[2 * 6 + 1][3].strong);
  EXPECT_TRUE(bands.rows[6 * 6][3].strong && !bands.rows[6 * 6 + 1][3].strong);
}

TEST(ReportDiagnosis, ExplanationsHaveTheirPlainNamesAndTheVerdictIsBold) {
  const auto dir = scratch("explanations");
  const auto bold = [&](const std::string& verdict) {
    std::vector<std::string> titles;
    for (const auto& row : explanation_table(diagnosed(dir, verdict)).rows)
      if (row[0].strong) titles.push_back(text_of(row[0]));
    return titles;
  };
  EXPECT_THAT(bold("named"), ElementsAre("the proton beam's profile (beam_profile)"));
  EXPECT_THAT(bold("ambiguous"), ElementsAre("the proton beam's profile (beam_profile)", "a wetted wall that the mercury leaves early (interface)"));
  EXPECT_THAT(bold("none"), ElementsAre("nothing is left out"));
  EXPECT_THAT(bold("unknown"), ElementsAre("something that was not tried"));
  const Study study = read_study(dir);
  EXPECT_EQ(reason_table(study).rows.size(), 4u);
  // The explanation that leads without being named is mentioned once.
  const char* leads = "The best of the explanations that were tried, the proton beam&#39;s profile (beam_profile), is not named: named: it accounts";
  EXPECT_THAT(diagnosis_section(study, input()).str(), HasSubstr(leads));
  EXPECT_THAT(diagnosis_section(diagnosed(dir, "named"), input()).str(), Not(HasSubstr("is not named")));
  const Table effects = effect_table(study);
  ASSERT_EQ(effects.rows.size(), 2u);
  EXPECT_EQ(text_of(effects.rows[0][2]), "2.31 \u00b1 0.16 mm");
  EXPECT_EQ(text_of(effects.rows[0][5]), "of the axis, upwards");
}

TEST(ReportDiagnosis, ParametersAreComparedWithTheHandbookBeforeAndAfter) {
  const auto dir = scratch("handbook");
  const auto in = input();
  const Table t = handbook_table(diagnosed(dir, "named"), in);
  ASSERT_EQ(t.rows.size(), 2u);
  EXPECT_EQ(text_of(t.rows[0][0]), "density [kg/m\u00b3]");
  EXPECT_DOUBLE_EQ(value_of(t.rows[0][5]), 2);  // (13905 - 13500) / 202.5
  EXPECT_TRUE(t.rows[0][5].strong);
  EXPECT_NEAR(value_of(t.rows[0][8]), 0.0988, 1e-3);
  EXPECT_FALSE(t.rows[0][8].strong);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(t.rows[1][5].value));  // the handbook has no value
  EXPECT_EQ(handbook_table(diagnosed(dir, "unknown"), in).columns.size(), 6u);
}

TEST(ReportDiagnosis, ItsTablesAndTracesAreWrittenAsCsv) {
  const auto dir = scratch("diagnosis_csv");
  const auto in = input();
  write_diagnosis(dir, in, "named");
  (void)write_tables_csv(dir, in);
  const Json d = read_json(dir / "diagnosis.json");
  const auto ranking = csv_of(dir / "report_csv/diagnosis_explanations.csv");
  ASSERT_EQ(ranking.size(), 5u);
  EXPECT_EQ(number_in(ranking, 0, "probability"), d["ranking"][0]["probability"].get<double>());
  const auto gauges = csv_of(dir / "report_csv/diagnosis_gauges.csv");
  EXPECT_EQ(number_in(gauges, 2, "q_value"), d["location"]["sensors"][2]["q_value"].get<double>());
  const auto traces = csv_of(dir / "report_csv/diagnosis_histories.csv");
  EXPECT_EQ(traces.size(), 1 + in.sensors.size() * 501);
  EXPECT_NEAR(number_in(traces, 2 * 501 + 200, "base"), 0.6e6 * wave(2e-4, 2, 1), 1e-6);
  for (const char* name : {"diagnosis_map", "diagnosis_bands", "diagnosis_reasons", "diagnosis_effects", "diagnosis_parameters"})
    EXPECT_TRUE(std::filesystem::exists(dir / "report_csv" / (std::string(name) + ".csv"))) << name;
}
