// `calomel campaign` as a whole: the repeatability floor at its end, a kill in it, and what belongs to a campaign's identity.
#include <signal.h>

#include <chrono>
#include <thread>

#include "base/artefact.hpp"
#include "base/netcdf_file.hpp"
#include "tests/regression/program.hpp"

using namespace calomel::testing;
using calomel::NetcdfReader;
using calomel::read_json;
using calomel::read_text;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

namespace {

const std::string slice = R"(
[geometry]
kind = "box"
length = 0.06
width = 0.05
height = 0.03
wall = 0.003
plane_strain = true
element_size = 0.003
[material.mercury]
density = 13500.0
sound_speed = 1450.0
tensile_cutoff = 1.5e5
[load]
peak_pressure = 25e6
profile = { center = [0.0, 0.015], widths = [0.1, 0.01] }
[time]
end = 4e-5
output_interval = 1e-6
[[sensor]]
name = "T"
position = [0.02, 0.0, 0.03]
direction = [1, 0, 0]
[[sensor]]
name = "F"
position = [0.0, 0.0, 0.015]
direction = [0, 0, 1]
[parameter.density]
min = 12000
max = 14500
[campaign]
runs = 3
[floor]
members = 3
window = 1e-5
single_runs = 2
)";

struct Folder {
  fs::path path = fs::path(::testing::TempDir()) / ("calomel_campaign_" + std::to_string(::getpid()));
  Folder() {
    fs::remove_all(path);
    fs::create_directories(path);
    std::ofstream(path / "case.toml") << slice;
  }
  ~Folder() { fs::remove_all(path); }
};

}  // namespace

TEST(CampaignVerb, MeasuresTheFloorAtItsEndAndStoresIt) {
  const Folder dir;
  const auto first = run(dir.path, "campaign case.toml --out a");
  ASSERT_EQ(first.status, 0) << first.said;
  EXPECT_THAT(first.said, HasSubstr("repeatability floor of the ensemble mean over 3 jitters"));
  const auto json = read_json(dir.path / "a" / "campaign.json"), floor = read_json(dir.path / "a" / "floor.json");
  for (const char* key : {"mean", "worst", "sensors", "members", "comparisons", "window_end_s"}) EXPECT_EQ(json["floor"][key], floor[key]) << key;
  ASSERT_EQ(floor["comparisons"].size(), 3u);
  for (const auto& c : floor["comparisons"]) EXPECT_GT(c["worst"].get<double>(), 0) << c["name"];
  const NetcdfReader file(dir.path / "a" / "campaign.nc");
  EXPECT_EQ(file.shape("floor_sd"), (std::vector<std::size_t>{2, 4}));
  EXPECT_EQ(file.doubles("floor_finer_mesh").at(1), floor["comparisons"][1]["sensors"][1]["relative"].get<double>());
  EXPECT_FALSE(fs::exists(dir.path / "a" / "floor.journal"));

  // One that stands is taken, to the same bytes; left out, there is none.
  fs::create_directories(dir.path / "b");
  fs::copy(dir.path / "a" / "floor.json", dir.path / "b" / "floor.json");
  const auto second = run(dir.path, "campaign case.toml --out b");
  EXPECT_THAT(second.said, Not(HasSubstr("measuring it first")));
  EXPECT_EQ(read_text(dir.path / "a" / "campaign.nc"), read_text(dir.path / "b" / "campaign.nc"));
  ASSERT_EQ(run(dir.path, "campaign case.toml --out c --set campaign.floor=false").status, 0);
  EXPECT_FALSE(fs::exists(dir.path / "c" / "floor.json"));
  EXPECT_FALSE(NetcdfReader(dir.path / "c" / "campaign.nc").has("floor_sd"));
}

TEST(CampaignVerb, KilledInTheFloorItGoesOnToTheSameBytes) {
  const Folder dir;
  ASSERT_EQ(run(dir.path, "campaign case.toml --out whole").status, 0);
  const fs::path killed = dir.path / "killed", journal = killed / "floor.journal";
  const pid_t child = ::fork();
  if (child == 0) {
    if (::chdir(dir.path.c_str()) == 0) ::execl(CALOMEL_PROGRAM, CALOMEL_PROGRAM, "campaign", "case.toml", "--out", "killed", "--quiet", "--threads", "1", nullptr);
    ::_exit(127);
  }
  // The head of the journal is below 4 000 bytes; a run adds some.
  int status = 0;
  std::uintmax_t head = 0;
  for (bool seen = false; !seen && ::waitpid(child, &status, WNOHANG) == 0; std::this_thread::sleep_for(std::chrono::microseconds(100))) {
    std::error_code none;
    const auto size = fs::file_size(journal, none);
    if (none) continue;
    if (head == 0) head = size;
    seen = size > head;
  }
  ::kill(child, SIGKILL);
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status)) << "it ended before it could be killed";
  ASSERT_TRUE(fs::exists(journal));
  EXPECT_FALSE(fs::exists(killed / "campaign.nc"));
  const auto last = run(dir.path, "campaign case.toml --out killed");
  ASSERT_EQ(last.status, 0) << last.said;
  EXPECT_THAT(last.said, HasSubstr("3 reused"));
  EXPECT_EQ(read_text(killed / "campaign.nc"), read_text(dir.path / "whole" / "campaign.nc"));
  auto a = read_json(killed / "floor.json"), b = read_json(dir.path / "whole" / "floor.json");
  a.erase("wall_s"), b.erase("wall_s");
  EXPECT_EQ(a, b);
}

// What changes no strain is no other campaign; what does is, by name.
TEST(CampaignVerb, IsTheSameWhetherEnergiesAreBookedOrNot) {
  const Folder dir;
  const std::string words = "campaign case.toml --set campaign.floor=false";
  ASSERT_EQ(run(dir.path, words).status, 0);
  EXPECT_THAT(run(dir.path, words + " --set solver.booking=false").said, HasSubstr("3 reused"));
  const auto other = run(dir.path, words + " --set solver.time_step_safety=0.9");
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.said, HasSubstr("solver.time_step_safety"));
}
