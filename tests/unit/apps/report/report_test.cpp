#include "apps/report/report.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "apps/report/parts/html.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/netcdf_file.hpp"
#include "tests/unit/apps/report/reading.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

namespace {

/// The addresses that the page would fetch: src or href of elements that load, other than data: and anchors.
std::vector<std::string> outside_loads(const std::string& page) {
  static const std::regex load("<(?:script|link|img|iframe)\\b[^>]*\\s(?:src|href)\\s*=\\s*[\"']?(?!data:|#)([^\"' >]+)", std::regex::icase);
  const std::string text = markup(page);
  std::vector<std::string> found;
  for (std::sregex_iterator i(text.begin(), text.end(), load), end; i != end; ++i) found.push_back((*i)[1]);
  return found;
}

}  // namespace

TEST(Report, LoadsNothingFromOutsideAndIsSmallerThanTenMegabytes) {
  const auto dir = scratch("loads");
  const auto in = input();
  write_study(dir, in);
  write_calibration(dir, in, "spe");
  const std::string page = report_of(dir, in);
  EXPECT_THAT(outside_loads(page), ElementsAre());
  EXPECT_THAT(markup(page), HasSubstr("default-src 'none'"));  // the browser may fetch nothing
  EXPECT_LT(page.size(), 10'000'000u);
  // Negative control: the search finds a load.
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
    EXPECT_THAT(text, HasSubstr("<th scope=\"row\" class=\"text\">" + Html(s.name).str() + "</th>"));
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

TEST(Report, AnEmptyFolderIsAnErrorThatNamesItAndTheCommandToRunFirst) {
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

// One artefact of any stage is enough. The page names the missing artefacts and the commands that make them.
TEST(Report, AFolderWithOneArtefactGivesAPageThatNamesTheMissingOnesAndTheirCommands) {
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

TEST(ReportCsv, ScoresEqualTheSummary) {
  const auto dir = scratch("scores");
  const auto in = input();
  write_study(dir, in);
  write_calibration(dir, in, "spe");
  const auto paths = write_tables_csv(dir, in);
  const Json enc = read_json(dir / "enc.json"), spe = read_json(dir / "spe.json");
  for (const std::string key : {"accuracy", "mae"}) {
    const auto csv = csv_of(dir / "report_csv" / (key + ".csv"));
    ASSERT_EQ(csv.size(), in.sensors.size() + 1);
    for (std::size_t i = 0; i < in.sensors.size(); ++i) {
      EXPECT_EQ(csv[i + 1][0], in.sensors[i].name);
      EXPECT_EQ(number_in(csv, i, "enc"), enc["sensors"][i][key].get<double>());
      EXPECT_EQ(number_in(csv, i, "spe"), spe["sensors"][i][key].get<double>());
      EXPECT_EQ(number_in(csv, i, "nominal"), enc["sensors"][i]["nominal_" + key].get<double>());
    }
  }
  for (const auto& p : paths) EXPECT_TRUE(std::filesystem::exists(p)) << p;
}

TEST(ReportCsv, ParametersRoundsCandidatesAndTracesEqualTheSummary) {
  const auto dir = scratch("tables");
  const auto in = input();
  write_study(dir, in);
  (void)write_tables_csv(dir, in);
  const Json enc = read_json(dir / "enc.json");
  const auto parameters = csv_of(dir / "report_csv/parameters.csv");
  for (std::size_t i = 0; i < in.parameters.size(); ++i) {
    EXPECT_EQ(number_in(parameters, i, "enc"), enc["theta"][in.parameters[i].name].get<double>());
    EXPECT_EQ(number_in(parameters, i, "max"), in.parameters[i].max);
  }
  EXPECT_DOUBLE_EQ(number_in(parameters, 3, "enc"), 10345.0 * 2020.0);  // impedance
  EXPECT_DOUBLE_EQ(number_in(parameters, 3, "nominal"), 13500.0 * 1450.0);

  const auto rounds = csv_of(dir / "report_csv/rounds.csv");
  ASSERT_EQ(rounds.size(), enc["rounds"].size() + 1);
  for (std::size_t i = 0; i < enc["rounds"].size(); ++i) {
    EXPECT_EQ(number_in(rounds, i, "objective"), enc["rounds"][i]["objective"].get<double>());
    EXPECT_EQ(number_in(rounds, i, "density"), enc["rounds"][i]["theta"]["density"].get<double>());
  }
  const auto candidates = csv_of(dir / "report_csv/candidates.csv");
  for (std::size_t i = 0; i < enc["candidates"].size(); ++i)
    EXPECT_EQ(number_in(candidates, i, "objective_model"), enc["candidates"][i]["objective_model"].get<double>());
  const auto traces = csv_of(dir / "report_csv/convergence.csv");
  EXPECT_EQ(traces.size(), 1u + 4 * 101);
  EXPECT_EQ(number_in(traces, 101, "objective"), enc["optimizers"][1]["trace"][0].get<double>());
  const auto failed = csv_of(dir / "report_csv/failed_runs.csv");
  EXPECT_EQ(failed.size(), 4u);
  EXPECT_EQ(number_in(failed, 0, "run"), 3);
}

TEST(ReportCsv, HistoriesAreWholeAndInMicrostrain) {
  const auto dir = scratch("histories");
  const auto in = input();
  write_study(dir, in);
  (void)write_tables_csv(dir, in);
  const auto csv = csv_of(dir / "report_csv/histories.csv");
  EXPECT_THAT(csv[0], ElementsAre("condition", "sensor", "time_s", "measured_mean", "band_low", "band_high", "nominal", "enc"));
  ASSERT_EQ(csv.size(), 1 + in.sensors.size() * 601);
  const NetcdfReader file(dir / "enc.nc");
  const auto calibrated = file.doubles("calibrated"), mean = file.doubles("record_mean");
  for (const std::size_t k : {0u, 100u, 500u}) {
    EXPECT_DOUBLE_EQ(number_in(csv, 601 + k, "enc"), calibrated[601 + k] * 1e6);
    EXPECT_DOUBLE_EQ(number_in(csv, 601 + k, "measured_mean"), mean[501 + k] * 1e6);
  }
  EXPECT_EQ(csv[1 + 601][1], in.sensors[1].name);
  EXPECT_EQ(csv[1 + 501][3], "");            // after the end of the records
  EXPECT_EQ(csv[1 + 5 * 601 + 205][3], "");  // within the last sensor's dropout
  EXPECT_NE(csv[1 + 5 * 601 + 205][7], "");  // the simulation has values there
}

TEST(ReportCsv, ATableOfARemovedStageIsRemoved) {
  const auto dir = scratch("stale");
  const auto in = input();
  write_study(dir, in);
  (void)write_tables_csv(dir, in);
  ASSERT_TRUE(std::filesystem::exists(dir / "report_csv/accuracy.csv"));
  std::filesystem::remove(dir / "enc.json");
  const auto paths = write_tables_csv(dir, in);
  EXPECT_FALSE(std::filesystem::exists(dir / "report_csv/accuracy.csv"));
  EXPECT_EQ(std::count(paths.begin(), paths.end(), dir / "report_csv/accuracy.csv"), 0);
}
