// `calomel calibrate` as a whole: the mode of the posterior, a nested model, and the correction for the mesh.
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/netcdf_file.hpp"
#include "tests/regression/slice_case.hpp"

using namespace calomel::testing;
using calomel::Json;
using calomel::NetcdfReader;
using calomel::read_json;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

namespace {

const std::string parameters =
    "[parameter.density]\nmin = 12000\nmax = 14500\n[campaign]\nruns = 10\n"
    "[surrogate]\ncompare = []\n";

/// A folder whose case has been run through a campaign, and one of its runs as the recordings.
fs::path folder(const std::string& name) {
  const std::string text = with(slice_case, "end = 2e-5", "end = 4e-5") + parameters;
  const auto dir = folder_with(name, {{"case.toml", text}});
  EXPECT_EQ(run(dir, "campaign case.toml --out a").status, 0);
  const NetcdfReader file(dir / "a" / "campaign.nc");
  const auto time = file.doubles("time"), strain = file.doubles("strain");
  std::ofstream csv(dir / "records.csv");
  csv << "sensor,pulse,time,strain\n";
  for (std::size_t t = 0; t < time.size(); ++t) csv << "A,1," << time[t] << ',' << strain[3 * time.size() + t] << '\n';
  std::ofstream(dir / "case.toml", std::ios::app) << "[recordings]\nfile = \"records.csv\"\nnoise = 5e-6\n";
  return dir;
}

}  // namespace

TEST(CalibrateVerb, MapIsTheModeOfThePosteriorWithTheEvidenceOfANestedModel) {
  const auto dir = folder("calibrate_map"), out = dir / "a";
  const std::string settings =
      " --set emulator.start=nominal --set emulator.viscosity_sd=0 --set emulator.coarse_runs=8 --set emulator.fine_runs=5 --set emulator.rounds=3 --set "
      "errors.young_sd=0 --set errors.wall_film_sd=0"
      " --set errors.gauge_place_sd=0 --set errors.band=1e5";
  const std::string words = "calibrate case.toml --out a --method map" + settings;
  const auto first = run(dir, words);
  ASSERT_TRUE(first.status == 0 || first.status == 4) << first.said;  // few runs: it may not have settled
  const Json map = read_json(out / "map.json");
  EXPECT_EQ(map["status"], first.status == 0 ? "done" : "not_settled");
  EXPECT_EQ(map["scores_on"], "the finest mesh of the emulator");
  EXPECT_FALSE(map["provenance"]["inputs"].contains("floor.json"));
  EXPECT_EQ(map["parameters"].size(), 1u);
  EXPECT_TRUE(map["score_tests"]["mechanisms"].is_array());
  EXPECT_NEAR(map["emulator"]["theta"]["density"].get<double>(), map["theta"]["density"].get<double>(), 1e-6);
  EXPECT_THAT(run(dir, words).said, HasSubstr("map: reused"));

  // Keys of before are answered with the new ones.
  const auto old = run(dir, words + " --set map.mesh_pairs=2");
  EXPECT_EQ(old.status, 2);
  EXPECT_THAT(old.said, HasSubstr("[emulator]"));

  // A larger model, whose beam the records know nothing of, on the runs of both.
  const std::string larger = with(calomel::read_text(dir / "case.toml"), "[campaign]",
                                  "[parameter.beam]\nkey = \"mechanism.beam_profile.offset_z\"\nmin = -0.004\nmax = 0.004\nnominal = "
                                  "0\n[mechanism.beam_profile]\nenabled = true\n[campaign]");
  std::ofstream(dir / "larger.toml") << larger;
  const auto compared = run(dir, "calibrate larger.toml --out b --method map --set map.compare_with=a --set map.score_tests=false" + settings);
  ASSERT_TRUE(compared.status == 0 || compared.status == 4) << compared.said;
  const Json nested = read_json(dir / "b" / "map.json")["nested_model"];
  EXPECT_EQ(nested["added"], Json::parse(R"(["beam"])"));
  EXPECT_EQ(nested["theta"]["beam"], 0.0);
  EXPECT_NE(nested["verdict"], "favoured") << nested["sentence"];
  const auto none = run(dir, "calibrate larger.toml --out c --method map --set map.compare_with=nowhere" + settings);
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.said, HasSubstr("holds no map.json"));
  const auto another = run(dir, "calibrate larger.toml --out d --method map --set map.compare_with=a --set material.steel.poisson=0.3" + settings);
  EXPECT_EQ(another.status, 2);
  EXPECT_THAT(another.said, HasSubstr("is not that of a"));
}

TEST(CalibrateVerb, SpeIsCorrectedForTheMeshByTheEmulatorAndReportsWhereItIsNot) {
  const auto dir = folder("calibrate_corrected"), out = dir / "a";
  const std::string words =
      "calibrate case.toml --out a --method spe --set spe.total_degree=[1,2] --set spe.tensor_product=[] --set spe.trials=4 --set spe.candidates=2 --set "
      "spe.zoom=1 --set spe.zoom_runs=10"
      " --set emulator.start=nominal --set emulator.viscosity_sd=0 --set emulator.coarse_runs=8 --set emulator.fine_runs=5 --set emulator.rounds=0 --set "
      "errors.young_sd=0 --set errors.wall_film_sd=0"
      " --set errors.gauge_place_sd=0";
  const auto elsewhere = run(dir, words + " --set emulator.element_sizes=[0.0015,0.001]");
  EXPECT_EQ(elsewhere.status, 2);
  EXPECT_THAT(elsewhere.said, HasSubstr("emulator.element_sizes"));
  EXPECT_THAT(elsewhere.said, HasSubstr("spe.mesh_correction = false"));
  const auto old = run(dir, words + " --set spe.mesh_pairs=2");
  EXPECT_EQ(old.status, 2);
  EXPECT_THAT(old.said, HasSubstr("mesh_correction = true | false"));

  const auto corrected = run(dir, words);
  ASSERT_EQ(corrected.status, 0) << corrected.said;
  Json spe = read_json(out / "spe.json");
  EXPECT_EQ(spe["scores_on"], "the finest mesh of the emulator");
  EXPECT_GT(spe["mesh"]["relative_difference"].get<double>(), 0);
  EXPECT_TRUE(spe["provenance"]["options"].contains("emulator"));
  EXPECT_FALSE(spe["provenance"]["inputs"].contains("floor.json"));
  EXPECT_TRUE(fs::exists(out / "runs.journal"));

  const auto one_mesh = run(dir, words + " --set emulator.element_sizes=[0.002] --fresh");
  ASSERT_EQ(one_mesh.status, 0) << one_mesh.said;
  EXPECT_THAT(one_mesh.said, HasSubstr("not corrected for the mesh"));
  spe = read_json(out / "spe.json");
  EXPECT_FALSE(spe.contains("mesh"));
  EXPECT_FALSE(spe["provenance"]["options"].contains("emulator"));
}

TEST(CalibrateVerb, TheSurrogateThatTheBasinIsFoundOnIsAnInputOfTheCorrection) {
  const auto dir = folder("calibrate_basin"), out = dir / "a";
  const std::string words =
      "calibrate case.toml --out a --method spe --set spe.total_degree=[1,2] --set spe.tensor_product=[] --set spe.trials=4 --set spe.candidates=2 --set "
      "spe.zoom=0"
      " --set emulator.viscosity_sd=0 --set emulator.coarse_runs=8 --set emulator.fine_runs=5 --set emulator.rounds=0 --set errors.young_sd=0 --set "
      "errors.wall_film_sd=0 --set errors.gauge_place_sd=0";
  const auto first = run(dir, words);
  ASSERT_EQ(first.status, 0) << first.said;
  EXPECT_THAT(first.said, HasSubstr("no trained surrogate in a: training it first"));
  const Json inputs = read_json(out / "spe.json")["provenance"]["inputs"];
  EXPECT_EQ(inputs.value("surrogate.nc", ""), calomel::hash_file(out / "surrogate.nc"));
  EXPECT_TRUE(inputs.contains("campaign.nc"));
  const auto again = run(dir, words);
  EXPECT_EQ(again.status, 0) << again.said;
  EXPECT_THAT(again.said, HasSubstr("spe: reused"));

  // Another surrogate is another basin.
  const std::string other = " --set surrogate.test_fraction=0.25";
  ASSERT_EQ(run(dir, "train case.toml --out a --fresh" + other).status, 0);
  const auto refused = run(dir, words + other);
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.said, HasSubstr("the input surrogate.nc"));
}
