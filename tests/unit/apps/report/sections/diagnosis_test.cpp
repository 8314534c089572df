#include "apps/report/sections/diagnosis.hpp"

#include <gmock/gmock.h>

#include <string>

#include "apps/report/data/study.hpp"
#include "apps/report/sections/diagnosis_tables.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/unit/apps/report/reading.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::HasSubstr;
using testing::Not;

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
    EXPECT_THAT(text, HasSubstr("over all gauges in 6 of 8 intervals of time and in 1 of 6 bands of frequency."));
    EXPECT_THAT(text, HasSubstr("previous_pulses: no room"));
    EXPECT_THAT(text, HasSubstr("The diagnosis took 412 runs"));
    EXPECT_THAT(text, HasSubstr("<li>beam_profile and interface</li>"));
    EXPECT_THAT(text, HasSubstr("differ most at gauge C."));
    EXPECT_THAT(text, Not(HasSubstr("<i>because")));
    EXPECT_THAT(text, Not(HasSubstr(hostile)));
  }
}

TEST(ReportDiagnosis, TheMissingPhysicsIsDescribedWhenTheVerdictIsUnknown) {
  for (const char* verdict : {"named", "none", "ambiguous", "unknown"}) {
    const auto dir = scratch("missing");
    const Study study = diagnosed(dir, verdict);
    const bool unknown = verdict == std::string("unknown");
    EXPECT_EQ(missing_table(study).rows.size(), unknown ? 1u : 0u) << verdict;
    const std::string text = diagnosis_section(study, input()).str();
    EXPECT_EQ(text.find("What is missing acts like a change &lt;b&gt;.") != std::string::npos, unknown) << verdict;
    EXPECT_EQ(text.find("<h3>Behaviour of the missing effect") != std::string::npos, unknown) << verdict;
  }
}

TEST(ReportDiagnosis, IsNotMentionedWhereThereIsNone) {
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

TEST(ReportDiagnosis, WarningsOfTheDiagnosisAreAmongTheOtherWarnings) {
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
  d["status"] = "not_to_be_trusted";
  d["base_fit"] = {{"message", "moves by 2 deviations a round"}};
  write_json(dir / "diagnosis.json", d);
  const std::string text = markup(report_of(dir, input()));
  EXPECT_THAT(text, HasSubstr("Not to be trusted:</strong> the fit of the base model: moves by 2 deviations a round."));
  const std::string name = d["ranking"][0]["name"];
  d["unsettled"] = {name};
  d["ranking"][0]["message"] = "still walks";
  write_json(dir / "diagnosis.json", d);
  EXPECT_THAT(markup(report_of(dir, input())), HasSubstr(": still walks."));
  EXPECT_THAT(text, HasSubstr("<li>diagnosis: a fit that decides the verdict has not settled"));
}

TEST(ReportDiagnosis, ADiagnosisOfAnEarlierVersionIsReadAsFarAsPossible) {
  const auto dir = scratch("earlier");
  write_json(
      dir / "diagnosis.json",
      {{"verdict", "unknown"}, {"reason", "nothing that was offered does"}, {"ranking", {{{"name", "none"}, {"probability", 1.0}, {"log_evidence", 0.0}}}}});
  const std::string text = markup(report_of(dir, input()));
  EXPECT_THAT(text, HasSubstr("Diagnosis: unknown. nothing that was offered does"));
  EXPECT_THAT(text, HasSubstr("diagnosis.nc is missing"));
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
