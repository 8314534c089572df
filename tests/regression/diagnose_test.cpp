// `calomel diagnose` and the page of its verdict as a whole: artefacts, sentences, reuse.
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/netcdf_file.hpp"
#include "tests/regression/slice_case.hpp"

using namespace calomel::testing;
using calomel::Json;
using calomel::NetcdfReader;
using calomel::read_json;
using calomel::read_text;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

namespace {

const std::string tables = R"([[sensor]]
name = "F"
position = [0.0, 0.0, 0.02]
direction = [0, 0, 1]
[[sensor]]
name = "G"
position = [0.03, 0.0, 0.0]
direction = [1, 0, 0]
[[sensor]]
name = "H"
position = [0.045, 0.0, 0.04]
direction = [1, 0, 0]
[[sensor]]
name = "I"
position = [0.012, 0.0, 0.0]
direction = [1, 0, 0]
[parameter.density]
min = 12000
max = 15000
[parameter.sound_speed]
min = 1250
max = 1650
[campaign]
pulses = 2
[emulator]
element_sizes = [0.004, 0.002]
viscosity_sd = 0
coarse_runs = 20
fine_runs = 10
rounds = 8
[errors]
band = 1e5
young_sd = 0
wall_film_sd = 0
beyond = 0
beyond_sd = 0.1
beyond_rest = 0.2
[diagnosis]
leaders = 2
pairs = false
[mechanism.beam_profile]
[mechanism.rear_reflection]
)";

/// A folder whose records are those of a beam that is 4 mm high, which the case does not know.
fs::path folder(const std::string& name) {
  const auto dir = folder_with(name, {{"case.toml", with(with(slice_case, "end = 2e-5", "end = 1.5e-4"), "riemer", "linear") + tables}});
  std::ofstream(dir / "truth.toml") << with(read_text(dir / "case.toml"), "[mechanism.beam_profile]\n",
                                            "[mechanism.beam_profile]\nenabled = true\noffset_z = 0.004\n");
  const auto made = run(dir, "simulate truth.toml --mean --out truth");
  EXPECT_EQ(made.status, 0) << made.said;
  put_records(dir);
  return dir;
}

}  // namespace

TEST(DiagnoseVerb, GivesItsVerdictInTwoSentencesWithWhichTheReportBegins) {
  const auto dir = folder("diagnose");
  const auto out = run(dir, "diagnose case.toml --out a");
  ASSERT_EQ(out.status, 0) << out.said;
  const Json json = read_json(dir / "a" / "diagnosis.json");
  for (const char* key : {"verdict", "mechanisms", "ranking", "location", "fit", "base_parameters", "absorbed", "separating_measurement", "summary", "finding",
                          "next_step", "gauges", "provenance"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_THAT(out.said, HasSubstr(json["summary"].get<std::string>()));
  ASSERT_EQ(json["verdict"], "named") << json["reason"];
  EXPECT_EQ(json["mechanisms"], Json::array({"beam_profile"}));
  EXPECT_THAT(json["finding"].get<std::string>(),
              HasSubstr("The simulation leaves something out: the proton beam's profile (beam_profile). With it the misfit of the records falls from"));
  EXPECT_THAT(json["next_step"].get<std::string>(), HasSubstr("beam monitors"));
  ASSERT_EQ(json["gauges"].size(), 5u);
  for (const auto& g : json["gauges"]) EXPECT_LT(g["heldout_after"].get<double>(), g["heldout_before"].get<double>()) << g["name"];
  double sum = 0;
  for (const auto& r : json["ranking"]) sum += r["probability"].get<double>();
  EXPECT_NEAR(sum, 1, 1e-9);
  const NetcdfReader file(dir / "a" / "diagnosis.nc");
  EXPECT_EQ(file.dimensions("base"), (std::vector<std::string>{"condition", "sensor", "time"}));
  EXPECT_EQ(file.shape("held_out_base"), file.shape("base"));
  EXPECT_EQ(file.attribute("verdict"), json["verdict"].get<std::string>());

  // The same call again is answered by what stands; without the histories it is done again, from the journal.
  EXPECT_THAT(run(dir, "diagnose case.toml --out a").said, HasSubstr("diagnose: reused"));
  fs::remove(dir / "a" / "diagnosis.nc");
  const auto journal = fs::file_size(dir / "a" / "runs.journal");
  EXPECT_EQ(run(dir, "diagnose case.toml --out a").status, 0);
  EXPECT_TRUE(fs::exists(dir / "a" / "diagnosis.nc"));
  EXPECT_EQ(fs::file_size(dir / "a" / "runs.journal"), journal);
  Json again = read_json(dir / "a" / "diagnosis.json"), before = json;
  again.erase("wall_s");
  before.erase("wall_s");
  EXPECT_EQ(again, before);

  const auto reported = run(dir, "report case.toml --out a --csv");
  ASSERT_EQ(reported.status, 0) << reported.said;
  const std::string page = read_text(dir / "a" / "report.html");
  const auto sentences = page.find("<p class=\"outcome verdict\"><strong>The simulation"), first = page.find("<section id=");
  ASSERT_NE(sentences, std::string::npos);
  EXPECT_LT(sentences, first);
  EXPECT_EQ(page.find("<section id=\"diagnosis\""), first);
  EXPECT_THAT(page, HasSubstr("the proton beam&#39;s profile (beam_profile)"));
  EXPECT_THAT(page, Not(HasSubstr("diagnosis.nc is missing")));
  for (const char* table :
       {"diagnosis_gauges", "diagnosis_map", "diagnosis_bands", "diagnosis_explanations", "diagnosis_reasons", "diagnosis_parameters", "diagnosis_histories"})
    EXPECT_TRUE(fs::exists(dir / "a" / "report_csv" / (std::string(table) + ".csv"))) << table;
}

// Before measuring: no recordings are needed, a stronger beam and another gauge are tried, and a kill costs nothing that was run.
TEST(DiagnoseVerb, ReportsTheMechanismsThatAPlannedExperimentCouldName) {
  const auto dir = folder_with("diagnose_power", {{"case.toml", with(with(slice_case, "end = 2e-5", "end = 1.5e-4"), "riemer", "linear") + tables +
                                                                    "[power]\npulses = 10\nnoise = 2e-6\ngauges = 1\nenergies = [2]\n"}});
  const auto out = run(dir, "diagnose case.toml --power --out a");
  ASSERT_TRUE(out.status == 0 || out.status == 4) << out.said;
  EXPECT_THAT(out.said, HasSubstr("power: beam_profile.offset_z could be named from "));
  EXPECT_THAT(out.said, HasSubstr("power: with records at 2 times the beam power as well: "));
  const Json json = read_json(dir / "a" / "power.json");
  ASSERT_EQ(json["plans"].size(), 3u);
  EXPECT_EQ(json["plans"][0]["name"], "as planned");
  EXPECT_EQ(json["plans"][0]["gain"], 0.0);
  for (const auto& d : json["plans"][0]["numbers"]) {
    if (d["parameter"] != "beam_profile.offset_z") continue;
    EXPECT_GT(d["named_from"].get<double>(), 0);
    EXPECT_LT(d["named_from"].get<double>(), 4e-3);  // the diagnosis of such records names 4 mm
  }
  const auto journal = fs::file_size(dir / "a" / "power_runs.journal");
  fs::remove(dir / "a" / "power.json");
  EXPECT_EQ(run(dir, "diagnose case.toml --power --out a").status, out.status);
  EXPECT_EQ(fs::file_size(dir / "a" / "power_runs.journal"), journal);
  EXPECT_EQ(read_json(dir / "a" / "power.json"), json);
  EXPECT_EQ(run(dir, "diagnose case.toml --out b").status, 2);  // without records there is nothing to diagnose
}
