// `calomel calibrate` as a whole: what becomes of a summary when the floor that it reads is measured anew, and the correction for the mesh.
#include "base/artefact.hpp"
#include "base/netcdf_file.hpp"
#include "base/provenance.hpp"
#include "tests/regression/slice_case.hpp"

using namespace calomel::testing;
using calomel::Json;
using calomel::NetcdfReader;
using calomel::read_json;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

namespace {

const std::string with_floor =
    "[parameter.density]\nmin = 12000\nmax = 14500\n[campaign]\nruns = 10\n[floor]\nmembers = 3\nwindow = 1e-5\nsingle_runs = 0\nfiner_mesh = false\nprecisions = false\n"
    "[surrogate]\ncompare = []\n[map]\nadded_runs = 0\nmesh_pairs = 0\npolish_runs = 4\nunknowns = { young_sd = 0, gauge_place_sd = 0 }\n";

/// A folder whose case has been run through a campaign, and one of its runs as the recordings.
fs::path folder(const std::string& name) {
  const std::string text = with(slice_case, "end = 2e-5", "end = 4e-5") + with_floor;
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

/// A summary whose inputs name the floor by these words, as if it had been written so.
void name_floor(const fs::path& summary, const std::string& words) {
  Json json = read_json(summary);
  Json& p = json["provenance"];
  p["inputs"]["floor.json"] = words;
  p["identity"] = calomel::Provenance{p["stage"], p["options"], p["seed"], p["inputs"]}.identity();
  calomel::write_json(summary, json);
}

}  // namespace

TEST(CalibrateVerb, AFloorMeasuredAnewDoesNotAskForFresh) {
  const auto dir = folder("calibrate_floor"), out = dir / "a";
  const std::string words = "calibrate case.toml --out a --method map";
  const auto first = run(dir, words);
  ASSERT_EQ(first.status, 0) << first.said;
  const Json map = read_json(out / "map.json");
  EXPECT_EQ(map["status"], "done");
  EXPECT_EQ(map["scores_on"], "the case's own mesh");

  // The same floor once more, in other bytes: nothing of it has changed for MAP.
  const std::string before = calomel::hash_file(out / "floor.json");
  Json floor = read_json(out / "floor.json");
  floor["wall_s"] = floor["wall_s"].get<double>() + 1;
  calomel::write_json(out / "floor.json", floor);
  ASSERT_NE(calomel::hash_file(out / "floor.json"), before);
  EXPECT_THAT(run(dir, words).said, HasSubstr("map: reused"));

  // A MAP of when the bytes counted stands as long as these are there, and is refused when the scatter is another.
  name_floor(out / "map.json", calomel::hash_file(out / "floor.json"));
  EXPECT_THAT(run(dir, words).said, HasSubstr("map: reused"));
  Json wider = floor;
  wider["sensors"][0]["sd"][0] = 2 * floor["sensors"][0]["sd"][0].get<double>();
  calomel::write_json(out / "floor.json", wider);
  const auto refused = run(dir, words);
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.said, HasSubstr("the input floor.json"));

  // A floor of before there were comparisons gives way, and what was made from it with it.
  floor.erase("comparisons"), floor["provenance"]["options"].erase("floor");
  calomel::write_json(out / "floor.json", floor);
  name_floor(out / "map.json", calomel::hash_file(out / "floor.json"));
  const auto again = run(dir, words);
  EXPECT_EQ(again.status, 0) << again.said;
  EXPECT_THAT(again.said, HasSubstr("measured anew"));
  EXPECT_THAT(again.said, HasSubstr("map.json, made from it, is set aside"));
  EXPECT_THAT(again.said, Not(HasSubstr("--fresh")));
  EXPECT_TRUE(fs::exists(out / "map.json.old-1"));
  EXPECT_TRUE(read_json(out / "floor.json").contains("comparisons"));
  EXPECT_EQ(read_json(out / "map.json")["theta"], map["theta"]);
}

TEST(CalibrateVerb, SpeIsCorrectedForTheMeshByTheEmulatorAndSaysWhereItIsNot) {
  const auto dir = folder("calibrate_corrected"), out = dir / "a";
  const std::string words =
      "calibrate case.toml --out a --method spe --set spe.total_degree=[1,2] --set spe.tensor_product=[] --set spe.trials=4 --set spe.candidates=2 --set spe.zoom=1 --set spe.zoom_runs=10"
      " --set emulator.start=nominal --set emulator.viscosity_sd=0 --set emulator.coarse_runs=8 --set emulator.fine_runs=5 --set emulator.rounds=0 --set errors.young_sd=0"
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
