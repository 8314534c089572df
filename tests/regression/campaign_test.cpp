// `calomel campaign` as a whole: the repeatability floor at its end, a kill in it, and what belongs to a campaign's identity.
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/netcdf_file.hpp"
#include "tests/regression/slice_case.hpp"

using namespace calomel::testing;
using calomel::NetcdfReader;
using calomel::read_json;
using calomel::read_text;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

namespace {

/// Few elements, 40 us, one parameter, the fewest runs.
fs::path folder(const std::string& name) {
  const std::string more = "[parameter.density]\nmin = 12000\nmax = 14500\n[campaign]\nruns = 3\n[floor]\nmembers = 3\nwindow = 1e-5\nsingle_runs = 2\n";
  return folder_with(name, {{"case.toml", with(slice_case, "end = 2e-5", "end = 4e-5") + more}});
}

}  // namespace

TEST(CampaignVerb, MeasuresTheFloorAtItsEndAndStoresIt) {
  const auto dir = folder("campaign_floor");
  const auto first = run(dir, "campaign case.toml --out a");
  ASSERT_EQ(first.status, 0) << first.said;
  EXPECT_THAT(first.said, HasSubstr("repeatability floor of the ensemble mean over 3 jitters"));
  const auto json = read_json(dir / "a" / "campaign.json"), floor = read_json(dir / "a" / "floor.json");
  for (const char* key : {"mean", "worst", "sensors", "members", "comparisons", "window_end_s"}) EXPECT_EQ(json["floor"][key], floor[key]) << key;
  ASSERT_EQ(floor["comparisons"].size(), 3u);
  for (const auto& c : floor["comparisons"]) EXPECT_GT(c["worst"].get<double>(), 0) << c["name"];
  const NetcdfReader file(dir / "a" / "campaign.nc");
  EXPECT_EQ(file.shape("floor_sd"), (std::vector<std::size_t>{1, 4}));
  EXPECT_EQ(file.doubles("floor_finer_mesh").at(0), floor["comparisons"][1]["sensors"][0]["relative"].get<double>());
  EXPECT_FALSE(fs::exists(dir / "a" / "floor.journal"));

  // One that stands is taken, to the same bytes; left out, there is none.
  fs::create_directories(dir / "b");
  fs::copy(dir / "a" / "floor.json", dir / "b" / "floor.json");
  const auto second = run(dir, "campaign case.toml --out b");
  EXPECT_THAT(second.said, Not(HasSubstr("measuring it first")));
  EXPECT_EQ(read_text(dir / "a" / "campaign.nc"), read_text(dir / "b" / "campaign.nc"));
  ASSERT_EQ(run(dir, "campaign case.toml --out c --set campaign.floor=false").status, 0);
  EXPECT_FALSE(fs::exists(dir / "c" / "floor.json"));
  EXPECT_FALSE(NetcdfReader(dir / "c" / "campaign.nc").has("floor_sd"));
}

TEST(CampaignVerb, InterruptedInTheFloorItResumesToTheSameBytes) {
  const auto dir = folder("campaign_killed");
  ASSERT_EQ(run(dir, "campaign case.toml --out whole").status, 0);
  const fs::path killed = dir / "killed", journal = killed / "runs.journal";
  const int status = stop_program(start_program(dir, {"campaign", "case.toml", "--out", "killed", "--quiet", "--threads", "1"}), SIGKILL, 1, [&] {
    return fs::exists(journal) && read_text(journal).find("jitter=") != std::string::npos;  // it has a run of the floor, at least
  });
  ASSERT_TRUE(status != -1 && WIFSIGNALED(status)) << "it ended before it could be killed";
  ASSERT_TRUE(fs::exists(journal));
  EXPECT_FALSE(fs::exists(killed / "campaign.nc"));
  const auto last = run(dir, "campaign case.toml --out killed");
  ASSERT_EQ(last.status, 0) << last.said;
  EXPECT_THAT(last.said, HasSubstr("3 reused"));
  EXPECT_EQ(read_text(killed / "campaign.nc"), read_text(dir / "whole" / "campaign.nc"));
  auto a = read_json(killed / "floor.json"), b = read_json(dir / "whole" / "floor.json");
  a.erase("wall_s");
  b.erase("wall_s");
  EXPECT_EQ(a, b);
}

// What changes no strain is no other campaign; what does is, by name.
TEST(CampaignVerb, IsTheSameWithAndWithoutAnEnergyBalance) {
  const auto dir = folder("campaign_energy_balance");
  const std::string words = "campaign case.toml --set campaign.floor=false";
  ASSERT_EQ(run(dir, words).status, 0);
  EXPECT_THAT(run(dir, words + " --set solver.energy_balance=false").said, HasSubstr("3 reused"));
  for (const char* key : {"energy_balance", "checkpoint", "subcycles"})
    EXPECT_FALSE(read_json(dir / "case.out" / "campaign.json")["provenance"]["options"]["solver"].contains(key)) << key;
  for (const auto& [key, value] : {std::pair<std::string, std::string>{"solver.time_step_safety", "0.9"}, {"solver.subcycles", "2"}}) {
    const auto other = run(dir, words + " --set " + key + "=" + value);
    EXPECT_EQ(other.status, 2);
    EXPECT_THAT(other.said, HasSubstr(key));
  }
}
