#include "apps/report/report.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "apps/report/page.hpp"
#include "apps/report/study.hpp"
#include "apps/report/surface.hpp"
#include "apps/report/table.hpp"
#include "apps/report/tables.hpp"
#include "apps/report/traces.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/unit/apps/report_study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

namespace {

/// The page without the bodies of its scripts and styles.
std::string markup(const std::string& page) {
  std::string out;
  std::size_t at = 0;
  for (;;) {
    const auto script = page.find("<script", at), style = page.find("<style", at), open = std::min(script, style);
    if (open == std::string::npos) return out + page.substr(at);
    const auto body = page.find('>', open) + 1;
    out += page.substr(at, body - at);
    at = page.find(script < style ? "</script>" : "</style>", body);
  }
}

/// What the page would fetch: src or href of elements that load, other than data: and anchors.
std::vector<std::string> outside_loads(const std::string& page) {
  static const std::regex load("<(?:script|link|img|iframe)\\b[^>]*\\s(?:src|href)\\s*=\\s*[\"']?(?!data:|#)([^\"' >]+)", std::regex::icase);
  const std::string text = markup(page);
  std::vector<std::string> found;
  for (std::sregex_iterator i(text.begin(), text.end(), load), end; i != end; ++i) found.push_back((*i)[1]);
  return found;
}

std::string report_of(const std::filesystem::path& dir, const ReportInput& in) {
  write_report(dir, in);
  return read_text(dir / "report.html");
}

Json data_of(const std::string& page) {
  const std::string open = "<script type=\"application/json\" id=\"report-data\">";
  const auto at = page.find(open) + open.size();
  return Json::parse(page.substr(at, page.find("</script>", at) - at));
}

/// RFC 4180: rows of fields, the header first.
std::vector<std::vector<std::string>> csv_of(const std::filesystem::path& path) {
  std::vector<std::vector<std::string>> rows{{""}};
  bool quoted = false;
  const std::string text = read_text(path);
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (quoted && text[i] == '"' && i + 1 < text.size() && text[i + 1] == '"')
      rows.back().back() += '"', ++i;
    else if (text[i] == '"')
      quoted = !quoted;
    else if (!quoted && text[i] == ',')
      rows.back().emplace_back();
    else if (!quoted && text[i] == '\n')
      rows.emplace_back(1, "");
    else
      rows.back().back() += text[i];
  }
  rows.pop_back();  // after the last line end
  return rows;
}

double number_in(const std::vector<std::vector<std::string>>& csv, std::size_t row, const std::string& column) {
  const auto at = std::find(csv[0].begin(), csv[0].end(), column);
  if (at == csv[0].end()) throw std::runtime_error("no column " + column);
  return std::stod(csv.at(row + 1).at(std::size_t(at - csv[0].begin())));
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
  for (const char* name : {"page.css", "drawing.js", "histories.js", "target.js", "corner.js", "page.js"})
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

TEST(Report, TellsTheRepeatabilityFloorOrHowToMeasureIt) {
  const auto dir = scratch("floor");
  const auto in = input();
  write_study(dir, in);
  const std::string text = markup(report_of(dir, in));
  EXPECT_THAT(text, HasSubstr("here <strong>6.1\u00a0%</strong> of the signal on average over the gauges, 9.2\u00a0% at the worst (&lt;b&gt;"));
  EXPECT_THAT(text, HasSubstr("<strong>9.2</strong>"));
  EXPECT_THAT(text, HasSubstr("0.035"));  // single against double precision [%]
  EXPECT_THAT(text, HasSubstr("left out: that mesh would have too many elements"));
  EXPECT_THAT(text, Not(HasSubstr("No repeatability floor")));

  // Without a campaign that of check --floor; without that, the way to it.
  std::filesystem::remove(dir / "campaign.json");
  EXPECT_THAT(markup(report_of(dir, in)), HasSubstr("calomel check slice.toml --floor"));
  write_json(dir / "floor.json", repeatability(in));
  EXPECT_THAT(markup(report_of(dir, in)), HasSubstr("9.2\u00a0% at the worst"));
}

TEST(ReportCsv, TheFloorEqualsTheSummary) {
  const auto dir = scratch("floor_csv");
  const auto in = input();
  write_study(dir, in);
  (void)write_tables_csv(dir, in);
  const Json all = read_json(dir / "campaign.json")["floor"];
  const auto rows = csv_of(dir / "report_csv/floor.csv");
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(number_in(rows, 0, "mean"), all["mean"].get<double>());
  EXPECT_EQ(number_in(rows, 1, "worst"), all["comparisons"][0]["worst"].get<double>());
  EXPECT_EQ(rows[3][1], "");  // no numbers of what was left out
  const auto gauges = csv_of(dir / "report_csv/floor_by_gauge.csv");
  EXPECT_THAT(gauges[0], ElementsAre("gauge", "floor", "single_runs", "precision"));
  const auto windows = csv_of(dir / "report_csv/floor_by_window.csv");
  ASSERT_EQ(windows.size(), 3u);
  for (std::size_t s = 0; s < in.sensors.size(); ++s) {
    EXPECT_EQ(gauges[s + 1][0], in.sensors[s].name);
    EXPECT_EQ(number_in(gauges, s, "floor"), all["sensors"][s]["relative"].get<double>());
    EXPECT_EQ(number_in(gauges, s, "single_runs"), all["comparisons"][0]["sensors"][s]["relative"].get<double>());
    EXPECT_EQ(windows[2][s + 2], number_text(all["sensors"][s]["sd"][1].get<double>()));
  }
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
  EXPECT_NE(csv[1 + 5 * 601 + 205][7], "");  // where the simulation goes on
}

TEST(ReportCsv, ATableOfAStageThatIsGoneDoesNotStay) {
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
  EXPECT_THAT(page, HasSubstr("These scores are corrected for the mesh, as the runs on finer meshes tell; on the case\u2019s own mesh it is 51.5\u00a0% and 18.5"));
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

TEST(ReportTables, CsvQuotesWhatMustBeQuoted) {
  EXPECT_EQ(csv_field("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_field("say \"x\""), "\"say \"\"x\"\"\"");
  EXPECT_EQ(csv_field("plain"), "plain");
}

TEST(ReportTraces, ThinningKeepsTheGreatestAndLeastValue) {
  std::vector<double> t, y;
  for (int i = 0; i < 10007; ++i) t.push_back(i), y.push_back(std::sin(i * 0.01));
  y[5003] = 40, y[5004] = -50;
  const Thinning thin(t.size(), 500);
  const auto times = thin.times(t), values = thin.extremes(y);
  ASSERT_EQ(times.size(), values.size());
  EXPECT_LE(values.size(), 502u);
  EXPECT_EQ(*std::max_element(values.begin(), values.end()), 40);
  EXPECT_EQ(*std::min_element(values.begin(), values.end()), -50);
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
  EXPECT_EQ(std::set<double>(times.begin(), times.end()).size(), times.size());
  for (std::size_t n = 501; n < 540; ++n) {  // whatever the size of the last window
    const Thinning odd(n, 500);
    EXPECT_EQ(odd.times(std::span(t).first(n)).size(), odd.extremes(std::span(y).first(n)).size()) << n;
  }
}

TEST(ReportTraces, InterpolationGivesSamplesExactlyAndNothingOutside) {
  const std::vector<double> t{0, 1, 2}, y{5, 7, std::nan("")}, at{-0.5, 0, 0.5, 1, 1.5, 2.5};
  const auto v = interpolated(t, y, at);
  EXPECT_TRUE(std::isnan(v[0]));
  EXPECT_EQ(v[1], 5);
  EXPECT_EQ(v[2], 6);
  EXPECT_EQ(v[3], 7);  // although its neighbour is absent
  EXPECT_TRUE(std::isnan(v[4]));
  EXPECT_TRUE(std::isnan(v[5]));
}

TEST(ReportTraces, ALongStudyIsThinnedUntilThePageFits) {
  const auto dir = scratch("long");
  auto in = input();
  const auto sensors = in.sensors;
  for (int copy = 1; copy < 20; ++copy)
    for (auto s : sensors) s.name += std::to_string(copy), in.sensors.push_back(s);
  write_calibration(dir, in, "enc", 2e-7);  // 120 sensors of 3001 samples
  const std::string page = report_of(dir, in);
  EXPECT_LT(page.size(), 10'000'000u);
  const Json data = data_of(page);
  EXPECT_TRUE(data["histories"]["thinned"].get<bool>());
  EXPECT_EQ(data["histories"]["conditions"][0]["sensors"].size(), 120u);
}

TEST(ReportSurface, ThinningKeepsTheBoxAndItsLimit) {
  const Vec3 low{0, -0.05, 0}, high{0.211, 0.05, 0.062};
  const ReportSurface fine = box(low, high, 300);
  ASSERT_GT(fine.quads.size(), 50000u);
  const ReportSurface thin = thinned(fine, 5000);
  EXPECT_LE(thin.quads.size(), 5000u);
  EXPECT_GT(thin.quads.size(), 1000u);
  for (int axis = 0; axis < 3; ++axis) {
    double least = 1, greatest = -1;
    for (const auto& v : thin.vertices) least = std::min(least, v[axis]), greatest = std::max(greatest, v[axis]);
    EXPECT_EQ(least, low[axis]);
    EXPECT_EQ(greatest, high[axis]);
  }
  // The surface stays closed to within a cell: its area is that of the box.
  double area = 0;
  for (const auto& q : thin.quads) {
    Vec3 d1, d2;
    for (int i = 0; i < 3; ++i) d1[i] = thin.vertices[q[2]][i] - thin.vertices[q[0]][i], d2[i] = thin.vertices[q[3]][i] - thin.vertices[q[1]][i];
    area += 0.5 * std::hypot(d1[1] * d2[2] - d1[2] * d2[1], d1[2] * d2[0] - d1[0] * d2[2], d1[0] * d2[1] - d1[1] * d2[0]);
  }
  const double exact = 2 * (0.211 * 0.1 + 0.211 * 0.062 + 0.1 * 0.062);
  EXPECT_NEAR(area, exact, 0.03 * exact);
  EXPECT_EQ(thinned(fine, fine.quads.size()).quads.size(), fine.quads.size());
}

TEST(ReportSurface, TheMeshGivesOnlyTheNodesOfItsFaces) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.nodes.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2)});
  mesh.outer.push_back({{4, 5, 7, 6}, 0});
  const ReportSurface s = report_surface(mesh, mesh.outer);
  ASSERT_EQ(s.vertices.size(), 4u);
  ASSERT_EQ(s.quads.size(), 1u);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(s.vertices[std::size_t(s.quads[0][i])], mesh.nodes[std::size_t(mesh.outer[0].nodes[i])]);
}
