#include "apps/report/report.hpp"

#include <gmock/gmock.h>

#include <regex>
#include <set>

#include "apps/report/page.hpp"
#include "apps/report/study.hpp"
#include "apps/report/table.hpp"
#include "apps/report/tables.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/unit/apps/report_reading.hpp"
#include "tests/unit/apps/report_study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

namespace {

/// What the page would fetch: src or href of elements that load, other than data: and anchors.
std::vector<std::string> outside_loads(const std::string& page) {
  static const std::regex load("<(?:script|link|img|iframe)\\b[^>]*\\s(?:src|href)\\s*=\\s*[\"']?(?!data:|#)([^\"' >]+)", std::regex::icase);
  const std::string text = markup(page);
  std::vector<std::string> found;
  for (std::sregex_iterator i(text.begin(), text.end(), load), end; i != end; ++i) found.push_back((*i)[1]);
  return found;
}

}  // namespace

TEST(Report, LoadsNothingFromOutsideAndStaysBelowTenMegabytes) {
  const auto dir = scratch("loads");
  const auto in = input();
  write_study(dir, in);
  write_calibration(dir, in, "spe");
  const std::string page = report_of(dir, in);
  EXPECT_THAT(outside_loads(page), ElementsAre());
  EXPECT_THAT(markup(page), HasSubstr("default-src 'none'"));  // and the browser is told to fetch nothing
  EXPECT_LT(page.size(), 10'000'000u);
  // Negative control: the search does find a load.
  EXPECT_THAT(outside_loads("<p><img alt='' src=\"https://a.example/x.png\"><script src=b.js></script>"), ElementsAre("https://a.example/x.png", "b.js"));
}

TEST(Report, HoldsTheScriptsOfTheRepositoryAndBothLibraries) {
  const auto dir = scratch("scripts");
  write_study(dir, input());
  const std::string page = report_of(dir, input());
  for (const char* name : {"page.css", "drawing.js", "histories.js", "target.js", "diagnosis.js", "chains.js", "corner.js", "sensitivity.js", "page.js"})
    EXPECT_THAT(page, HasSubstr(read_text(std::filesystem::path(CALOMEL_SOURCE_DIR) / "apps/report" / name))) << name;
  EXPECT_THAT(page, HasSubstr("Dygraph"));
  EXPECT_THAT(page, HasSubstr("WebGLRenderer"));
  EXPECT_THAT(page, HasSubstr("OrbitControls"));
}

TEST(Report, ShowsEverySensorInTablesTracesAndPicture) {
  const auto dir = scratch("sensors");
  const auto in = input();
  write_study(dir, in);
  const std::string page = report_of(dir, in), text = markup(page);
  const Json data = data_of(page);
  std::set<std::string> drawn, placed;
  for (const auto& s : data["histories"]["conditions"][0]["sensors"]) {
    drawn.insert(s["name"].get<std::string>());
    for (const char* key : {"measured", "low", "high", "nominal", "enc"}) EXPECT_EQ(s.at(key).size(), data["histories"]["time"].size()) << key;
  }
  for (const auto& s : data["target"]["sensors"]) placed.insert(s["name"].get<std::string>());
  for (const auto& s : in.sensors) {
    EXPECT_TRUE(drawn.contains(s.name)) << s.name;
    EXPECT_TRUE(placed.contains(s.name)) << s.name;
    EXPECT_THAT(text, HasSubstr("<th scope=\"row\" class=\"text\">" + escape_html(s.name) + "</th>"));
  }
}

TEST(Report, EscapesNamesAndMessages) {
  const auto dir = scratch("escape");
  auto in = input();
  in.case_name = "<script>alert(1)</script>";
  in.options["note"] = "</script><img src=x>";
  in.load_policy = "<i>fixed</i>";
  write_study(dir, in);
  const std::string page = report_of(dir, in), text = markup(page);
  EXPECT_THAT(text, Not(HasSubstr(hostile)));
  EXPECT_THAT(text, HasSubstr("&lt;b&gt;&quot;E&quot; &amp; &#39;co&#39;&lt;/b&gt;"));
  EXPECT_THAT(text, HasSubstr("&lt;script&gt;alert(1)&lt;/script&gt;"));
  EXPECT_THAT(text, Not(HasSubstr("<i>fixed")));
  EXPECT_THAT(text, Not(HasSubstr("<img")));
  EXPECT_THAT(text, HasSubstr("collapsed &lt;at tensile_cutoff"));
  // The data block survives the round trip and cannot end its element early.
  EXPECT_EQ(data_of(page)["target"]["sensors"].back()["name"], hostile);
}

TEST(Report, SaysInPlainWordsWhatCameOut) {
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

TEST(Report, AWarningOfSeveralMethodsStandsOnceWithAllOfThem) {
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
  enc["accuracy"] = 60.0, enc["mae"] = 30.0;
  write_json(dir / "enc.json", enc);
  const std::string text = markup(report_of(dir, in));
  EXPECT_THAT(text, HasSubstr("Neither is better than with the nominal values."));
  EXPECT_THAT(text, Not(HasSubstr("Both are better")));
}

TEST(Report, AnEmptyFolderIsAnErrorThatNamesItAndWhatToRunFirst) {
  const auto dir = scratch("empty");
  for (const auto& folder : {dir, dir / "absent"})
    for (const bool csv : {false, true}) try {
        csv ? (void)write_tables_csv(folder, input()) : write_report(folder, input());
        FAIL() << "it should have been refused";
      } catch (const InputError& e) {
        EXPECT_EQ(e.parts().file, folder.string());
        EXPECT_THAT(e.what(), HasSubstr("nothing to report"));
        EXPECT_THAT(e.what(), HasSubstr("calomel study slice.toml"));
      }
  EXPECT_TRUE(std::filesystem::is_empty(dir));
}

// One artefact of any stage is enough; the page says what else there could be and how to make it.
TEST(Report, AFolderWithLittleInItGivesAPageThatSaysWhatIsMissingAndHowToMakeIt) {
  const auto dir = scratch("little");
  write_json(dir / "simulate.json", {{"elements", 660}, {"steps", 100}});
  const std::string text = markup(report_of(dir, input()));
  EXPECT_THAT(text, HasSubstr("No calibration has been run yet"));
  for (const char* command :
       {"calomel campaign slice.toml", "calomel train slice.toml", "calomel calibrate slice.toml --method enc", "calomel study slice.toml"})
    EXPECT_THAT(text, HasSubstr(command));
}

TEST(Report, EveryArtefactMayBeMissingByItself) {
  const auto in = input();
  for (const char* gone : {"campaign.json", "campaign.nc", "train.json", "enc.json", "enc.nc"}) {
    const auto dir = scratch("gone");
    write_study(dir, in);
    std::filesystem::remove(dir / gone);
    const std::string text = markup(report_of(dir, in));
    EXPECT_THAT(text, HasSubstr(gone)) << gone;
    EXPECT_THAT(text, HasSubstr("class=\"missing\"")) << gone;
  }
}

TEST(Report, AnArtefactThatCannotBeReadIsNamed) {
  const auto dir = scratch("broken");
  write_atomically(dir / "enc.json", "{\"theta\": ");
  try {
    write_report(dir, input());
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("enc.json"));
  }
}

TEST(Report, AModelOfAnotherUnitIsShownInThatUnit) {
  const auto dir = scratch("unit");
  auto in = input();
  in.unit = "bar";
  write_study(dir, in);
  const std::string page = report_of(dir, in);
  EXPECT_EQ(data_of(page)["histories"]["unit"], "bar");
  EXPECT_THAT(markup(page), Not(HasSubstr("\u00b5\u03b5</strong>")));
}

TEST(ReportTables, BoldMarksWhereTheCalibratedSimulationIsAsGoodAsTheNominalOne) {
  const auto dir = scratch("bold");
  const auto in = input();
  write_calibration(dir, in, "enc");  // accuracy 92.25 - 7 s against 70.5; mae 12.125 + 2 s against 18.75
  const Study study = read_study(dir);
  const Table accuracy = score_table(study, in, "accuracy"), mae = score_table(study, in, "mae");
  for (std::size_t s = 0; s < in.sensors.size(); ++s) {
    EXPECT_EQ(accuracy.rows[s][2].strong, 92.25 - 7.0 * double(s) >= 70.5) << s;
    EXPECT_EQ(mae.rows[s][2].strong, 12.125 + 2.0 * double(s) <= 18.75) << s;
  }
  EXPECT_TRUE(accuracy.rows[3][2].strong && !accuracy.rows[4][2].strong);
  EXPECT_THAT(accuracy.html(), HasSubstr("<td><strong>92.2</strong></td>"));
  EXPECT_THAT(accuracy.html(), HasSubstr("Average"));
}

TEST(ReportTables, ScoresSayWhetherTheyAreCorrectedForTheMesh) {
  const auto dir = scratch("mesh");
  const auto in = input();
  write_calibration(dir, in, "enc");
  write_calibration(dir, in, "map");
  EXPECT_TRUE(mesh_table(read_study(dir), in).empty());
  EXPECT_THAT(score_table(read_study(dir), in, "accuracy").caption, testing::Not(HasSubstr("mesh")));
  Json enc = read_json(dir / "enc.json");
  enc["mesh"] = {{"relative_difference", 0.11}, {"working_mesh", {{"accuracy", 51.5}, {"mae", 18.5}, {"nominal_accuracy", 44.0}, {"nominal_mae", 25.0}}}};
  write_json(dir / "enc.json", enc);
  const Study study = read_study(dir);
  const Table mesh = mesh_table(study, in);
  ASSERT_EQ(mesh.rows.size(), 2u);
  EXPECT_THAT(mesh.csv(), HasSubstr("51.5"));
  EXPECT_THAT(mesh.csv(), HasSubstr("0.11"));
  EXPECT_THAT(score_table(study, in, "mae").html(), testing::Not(HasSubstr("51.5")));
  EXPECT_THAT(score_table(study, in, "accuracy").caption, HasSubstr("Simulations of ENC and the nominal one are corrected for the mesh"));
  EXPECT_THAT(score_table(study, in, "accuracy").caption, HasSubstr("the others are on the case\u2019s mesh"));
  const std::string page = header_html(study, in);
  EXPECT_THAT(page,
              HasSubstr("These scores are corrected for the mesh, as the runs on finer meshes tell; on the case\u2019s own mesh it is 51.5\u00a0% and 18.5"));
  EXPECT_EQ(page.find("These scores are corrected"), page.rfind("These scores are corrected"));  // of MAP nothing is told
}

TEST(ReportTables, NumbersReadAsAPersonWouldWriteThem) {
  EXPECT_EQ(number_html(0, 4), "0");
  EXPECT_EQ(number_html(1450, 4), "1450");
  EXPECT_EQ(number_html(13546.4, 4), "13\u202f546");
  EXPECT_EQ(number_html(0.5, 4), "0.5");
  EXPECT_EQ(number_html(-0.12345, 3), "\u22120.123");
  EXPECT_EQ(number_html(2.0897e7, 4), "2.09\u00b710<sup>7</sup>");
  EXPECT_EQ(number_html(7e-7, 4), "7\u00b710<sup>\u22127</sup>");
  EXPECT_EQ(number_html(9999.96, 5), "10\u202f000");
  EXPECT_EQ(fixed_html(-0.04, 1), "0.0");
  EXPECT_EQ(number_html(std::nan(""), 4), "\u2013");
}
