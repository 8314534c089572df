// The diagnosis' part of the page, for every kind of verdict.
#include "apps/report/diagnosis_tables.hpp"

#include <gmock/gmock.h>

#include "apps/report/traces.hpp"
#include "base/json.hpp"
#include "tests/unit/apps/report_reading.hpp"
#include "tests/unit/apps/report_study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

namespace {

/// The study of a folder that holds the diagnosis alone.
Study diagnosed(const std::filesystem::path& dir, const std::string& verdict) {
  write_diagnosis(dir, input(), verdict);
  return read_study(dir);
}

std::vector<std::string> keys_of(const Json& histories) {
  std::vector<std::string> keys;
  for (const auto& s : histories["series"]) keys.push_back(s["key"].get<std::string>());
  return keys;
}

std::string text_of(const Cell& cell) { return std::get<std::string>(cell.value); }
double value_of(const Cell& cell) { return std::get<double>(cell.value); }

}  // namespace

TEST(ReportDiagnosis, ItsSentencesComeFirstAndItsSectionBeforeAllOthers) {
  for (const char* verdict : {"named", "none", "ambiguous", "unknown"}) {
    const auto dir = scratch("diagnosis");
    const auto in = input();
    write_study(dir, in);
    write_diagnosis(dir, in, verdict);
    const std::string text = markup(report_of(dir, in));
    const auto finding = text.find("<strong>The finding of " + std::string(verdict) + ".</strong> The next step &lt;now&gt;.");
    ASSERT_NE(finding, std::string::npos) << verdict;
    EXPECT_LT(finding, text.find("What was run"));
    EXPECT_LT(text.find("<section id=\"diagnosis\""), text.find("<section id=\"parameters\""));
    EXPECT_LT(text.find("href=\"#diagnosis\">Left out"), text.find("href=\"#parameters\""));
    EXPECT_THAT(text, HasSubstr("Verdict: <strong>" + std::string(verdict) + "</strong>"));
    EXPECT_THAT(text, HasSubstr("first seen at gauge F from 100 \u00b5s on"));
    EXPECT_THAT(text, HasSubstr("over all gauges in 6 of 8 stretches of time and in 1 of 6 bands of frequency."));
    EXPECT_THAT(text, HasSubstr("previous_pulses: no room"));
    EXPECT_THAT(text, HasSubstr("It cost 412 runs"));
    EXPECT_THAT(text, HasSubstr("<li>beam_profile and interface</li>"));
    EXPECT_THAT(text, HasSubstr("differ most at gauge C."));
    EXPECT_THAT(text, Not(HasSubstr("<i>because")));
    EXPECT_THAT(text, Not(HasSubstr(hostile)));
  }
}

TEST(ReportDiagnosis, WhatIsMissingIsDescribedWhereItIsNotKnown) {
  for (const char* verdict : {"named", "none", "ambiguous", "unknown"}) {
    const auto dir = scratch("missing");
    const Study study = diagnosed(dir, verdict);
    const bool unknown = verdict == std::string("unknown");
    EXPECT_EQ(missing_table(study).rows.size(), unknown ? 1u : 0u) << verdict;
    const std::string text = diagnosis_section(study, input());
    EXPECT_EQ(text.find("What is missing acts like a change &lt;b&gt;.") != std::string::npos, unknown) << verdict;
    EXPECT_EQ(text.find("<h3>What is missing") != std::string::npos, unknown) << verdict;
  }
}

TEST(ReportDiagnosis, IsNotSpokenOfWhereThereIsNone) {
  const auto dir = scratch("no_diagnosis");
  const auto in = input();
  write_study(dir, in);
  const std::string page = report_of(dir, in), text = markup(page);
  EXPECT_THAT(text, Not(HasSubstr("id=\"diagnosis\"")));
  EXPECT_THAT(text, Not(HasSubstr("#diagnosis")));
  EXPECT_TRUE(data_of(page)["diagnosis"].is_null());
  EXPECT_TRUE(data_of(page)["diagnosis_histories"].is_null());
  EXPECT_TRUE(explanation_table(read_study(dir)).empty());
  EXPECT_TRUE(handbook_table(read_study(dir), in).empty());
}

TEST(ReportDiagnosis, AloneInAFolderItMakesAPage) {
  const auto dir = scratch("alone");
  write_diagnosis(dir, input(), "named");
  const std::string text = markup(report_of(dir, input()));
  EXPECT_THAT(text, HasSubstr("a diagnosis of omitted physics (412 runs of the model)"));
  EXPECT_THAT(text, Not(HasSubstr("No calibration has been run yet")));
}

TEST(ReportDiagnosis, WhatTheDiagnosisWarnsOfStandsWithTheOtherWarnings) {
  const auto dir = scratch("warned");
  write_diagnosis(dir, input(), "none");
  Json d = read_json(dir / "diagnosis.json");
  d["warnings"] = {"the model does not repeat itself"};
  EXPECT_THAT(markup(report_of(dir, input())), Not(HasSubstr("repeat itself")));
  write_json(dir / "diagnosis.json", d);
  EXPECT_THAT(markup(report_of(dir, input())), HasSubstr("<li>diagnosis: the model does not repeat itself</li>"));
}

TEST(ReportDiagnosis, AVerdictThatDidNotSettleIsNotToBeTrusted) {
  const auto dir = scratch("unsettled");
  write_diagnosis(dir, input(), "named");
  Json d = read_json(dir / "diagnosis.json");
  EXPECT_THAT(markup(report_of(dir, input())), Not(HasSubstr("Not to be trusted")));
  d["status"] = "not_to_be_trusted", d["base_fit"] = {{"message", "moves by 2 deviations a round"}};
  write_json(dir / "diagnosis.json", d);
  const std::string text = markup(report_of(dir, input()));
  EXPECT_THAT(text, HasSubstr("Not to be trusted:</strong> the fit of the base model: moves by 2 deviations a round."));
  const std::string name = d["ranking"][0]["name"];
  d["unsettled"] = {name}, d["ranking"][0]["message"] = "still walks";
  write_json(dir / "diagnosis.json", d);
  EXPECT_THAT(markup(report_of(dir, input())), HasSubstr(": still walks."));
  EXPECT_THAT(text, HasSubstr("<li>diagnosis: a fit on which the verdict hangs has not settled"));
}

TEST(ReportDiagnosis, OneOfAnEarlierVersionIsReadAsFarAsItGoes) {
  const auto dir = scratch("earlier");
  write_json(
      dir / "diagnosis.json",
      {{"verdict", "unknown"}, {"reason", "nothing that was offered does"}, {"ranking", {{{"name", "none"}, {"probability", 1.0}, {"log_evidence", 0.0}}}}});
  const std::string text = markup(report_of(dir, input()));
  EXPECT_THAT(text, HasSubstr("Diagnosis: unknown. nothing that was offered does"));
  EXPECT_THAT(text, HasSubstr("diagnosis.nc is missing"));
}

TEST(ReportDiagnosis, GaugesAreToldByMismatchAndWhatIsMoreThanChanceIsBold) {
  const auto dir = scratch("gauges");
  const Table named = mismatch_table(diagnosed(dir, "named"));
  ASSERT_EQ(named.rows.size(), 6u);
  EXPECT_DOUBLE_EQ(value_of(named.rows[2][1]), 5);  // the root of the score 25
  EXPECT_TRUE(named.rows[2][1].strong);
  EXPECT_EQ(text_of(named.rows[2][3]), "yes");
  EXPECT_FALSE(named.rows[0][1].strong);
  EXPECT_EQ(text_of(named.rows[0][3]), "no");
  EXPECT_DOUBLE_EQ(value_of(named.rows[2][5]), 0.06);
  // Without a name there is nothing to compare with.
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
  // The one that leads without being named is spoken of, once.
  const char* leads = "What comes nearest of what was tried, the proton beam&#39;s profile (beam_profile), is not named: named: it accounts";
  EXPECT_THAT(diagnosis_section(study, input()), HasSubstr(leads));
  EXPECT_THAT(diagnosis_section(diagnosed(dir, "named"), input()), Not(HasSubstr("is not named")));
  const Table effects = effect_table(study);
  ASSERT_EQ(effects.rows.size(), 2u);
  EXPECT_EQ(text_of(effects.rows[0][2]), "2.31 \u00b1 0.16 mm");
  EXPECT_EQ(text_of(effects.rows[0][5]), "of the axis, upwards");
}

TEST(ReportDiagnosis, ParametersAreHeldAgainstTheHandbookBeforeAndAfter) {
  const auto dir = scratch("handbook");
  const auto in = input();
  const Table t = handbook_table(diagnosed(dir, "named"), in);
  ASSERT_EQ(t.rows.size(), 2u);
  EXPECT_EQ(text_of(t.rows[0][0]), "density [kg/m\u00b3]");
  EXPECT_DOUBLE_EQ(value_of(t.rows[0][5]), 2);  // (13905 - 13500) / 202.5
  EXPECT_TRUE(t.rows[0][5].strong);
  EXPECT_NEAR(value_of(t.rows[0][8]), 0.0988, 1e-3);
  EXPECT_FALSE(t.rows[0][8].strong);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(t.rows[1][5].value));  // no handbook value of it
  EXPECT_EQ(handbook_table(diagnosed(dir, "unknown"), in).columns.size(), 6u);
}

TEST(ReportDiagnosis, DrawsEveryRecordWithBaseExplanationAndPrediction) {
  const auto dir = scratch("histories");
  const auto in = input();
  const Json named = diagnosis_histories_json(diagnosed(dir, "named"), in, 3000);
  EXPECT_THAT(keys_of(named), ElementsAre("measured", "base", "explained", "held_out_explained", "held_out_base"));
  EXPECT_EQ(named["series"][2]["label"], "simulation with beam_profile");
  EXPECT_FALSE(named["series"][3]["hidden"].get<bool>());
  EXPECT_TRUE(named["series"][4]["hidden"].get<bool>());
  ASSERT_EQ(named["conditions"][0]["sensors"].size(), in.sensors.size());
  EXPECT_EQ(named["scores"]["F"], "misfit 20.0\u00a0% \u2192 6.0\u00a0%, left out 25.0\u00a0% \u2192 12.5\u00a0%");
  const auto gauge = named["conditions"][0]["sensors"][2];
  EXPECT_NEAR(gauge["base"][200].get<double>(), 0.6e6 * wave(2e-4, 2, 1), 0.1);
  EXPECT_NEAR(gauge["measured"][200].get<double>(), 1e6 * wave(2e-4, 2, 1), 0.1);

  const Json unknown = diagnosis_histories_json(diagnosed(dir, "unknown"), in, 3000);
  EXPECT_EQ(unknown["series"][2]["label"], "simulation with beam_profile (nearest, not named)");
  const Json none = diagnosis_histories_json(diagnosed(dir, "none"), in, 3000);
  EXPECT_THAT(keys_of(none), ElementsAre("measured", "base", "held_out_base"));
  EXPECT_FALSE(none["series"][2]["hidden"].get<bool>());
  EXPECT_EQ(none["scores"]["F"], "misfit 20.0\u00a0%, left out 25.0\u00a0%");
}

TEST(ReportDiagnosis, HistoriesOfAnotherDiagnosisAreNotDrawn) {
  const auto dir = scratch("other");
  write_diagnosis(dir, input(), "named");
  Json d = read_json(dir / "diagnosis.json");
  d["provenance"]["identity"] = "another";
  write_json(dir / "diagnosis.json", d);
  EXPECT_FALSE(read_study(dir).diagnosis->histories.has_value());
  EXPECT_THAT(markup(report_of(dir, input())), HasSubstr("diagnosis.nc is missing or belongs to another diagnosis"));
}

TEST(ReportDiagnosis, TheScriptsGetEveryGaugeCellAndBar) {
  const auto dir = scratch("drawings");
  const Json d = diagnosis_drawings(diagnosed(dir, "named"));
  EXPECT_EQ(d["gauges"].size(), 6u);
  EXPECT_EQ(d["rows"].size(), 6u);
  EXPECT_EQ(d["times"]["columns"].size(), 8u);
  EXPECT_EQ(d["times"]["columns"][2]["label"], "100\u2013150");
  EXPECT_EQ(d["times"]["cells"][2][2]["mismatch"], 6);
  EXPECT_TRUE(d["times"]["cells"][2][2]["significant"].get<bool>());
  EXPECT_FALSE(d["times"]["cells"][2][1]["significant"].get<bool>());
  EXPECT_EQ(d["bands"]["columns"][0]["label"], "0\u201310");
  EXPECT_EQ(d["bands"]["cells"][2][0]["mismatch"], 5);
  EXPECT_TRUE(d["bands"]["cells"][2][0]["significant"].get<bool>());
  ASSERT_EQ(d["bars"].size(), 4u);
  EXPECT_TRUE(d["bars"][0]["strong"].get<bool>());
  EXPECT_EQ(d["bars"][0]["probability"], 0.9);
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
