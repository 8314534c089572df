// `calomel simulate` as a whole: a run that is killed goes on and ends the same; what simulate.json and fields.exo hold.
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/netcdf_file.hpp"
#include "tests/regression/slice_case.hpp"

using namespace calomel::testing;
using calomel::NetcdfReader;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

namespace {

/// Small elements and frequent checkpoints: long enough to be killed.
std::string slice() {
  std::string text = with(with(slice_case, "length = 0.06", "length = 0.08"), "wall = 0.004", "wall = 0.003");
  text = with(with(text, "element_size = 0.002", "element_size = 0.0005"), "widths = [0.1, 0.02]", "widths = [0.1, 0.01]");
  return with(text, "end = 2e-5", "end = 1.2e-4") + "[solver]\ncheckpoint = 0.001\n[fields]\ninterval = 4e-6\n";
}

fs::path folder() { return folder_with("simulate", {{"case.toml", slice()}}); }

/// `calomel simulate` of the case with these words as a child, its output to `killed`.
pid_t start(const fs::path& dir, std::vector<std::string> words) {
  words.insert(words.begin(), {"simulate", "case.toml", "--out", "killed", "--quiet"});
  return start_program(dir, words);
}

/// Starts the program and kills it once it has left `saves` new checkpoints. Whether it was still at work.
bool kill_after(const fs::path& dir, const std::vector<std::string>& words, int saves, const std::string& name = "simulate.checkpoint") {
  const auto stamp = [checkpoint = dir / "killed" / name] {
    std::error_code none;
    const auto t = fs::last_write_time(checkpoint, none);
    return none ? fs::file_time_type::min() : t;
  };
  auto last = stamp();
  return WIFSIGNALED(stop_program(start(dir, words), SIGKILL, saves, [&] {
    const auto now = stamp();
    const bool fresh = now != last && now != fs::file_time_type::min();
    last = now;
    return fresh;
  }));
}

}  // namespace

TEST(Simulate, InterruptedAtAnyInstantItResumesToTheSameResult) {
  const auto dir = folder();
  ASSERT_EQ(run(dir, "simulate case.toml --fields --out whole --set solver.checkpoint=0").status, 0);
  EXPECT_FALSE(fs::exists(dir / "whole" / "simulate.checkpoint"));
  for (const int saves : {5, 1, 17}) ASSERT_TRUE(kill_after(dir, {"--fields"}, saves)) << "it ended before it could be killed";
  EXPECT_FALSE(fs::exists(dir / "killed" / "simulate.nc"));

  // Another case does not go on with it; --fields belongs to the run as well.
  for (const char* other : {"--fields --set load.peak_pressure=26e6", ""}) {
    const auto refused = run(dir, std::string("simulate case.toml --out killed ") + other);
    EXPECT_EQ(refused.status, 2);
    EXPECT_THAT(refused.said, HasSubstr("the checkpoint is of another run"));
  }
  const auto last = run(dir, "simulate case.toml --fields --out killed --threads 2");
  ASSERT_EQ(last.status, 0) << last.said;
  EXPECT_THAT(last.said, HasSubstr("resumes from step"));
  EXPECT_FALSE(fs::exists(dir / "killed" / "simulate.checkpoint"));
  EXPECT_FALSE(fs::exists(dir / "killed" / "fields.exo.part"));

  const NetcdfReader a(dir / "whole" / "simulate.nc"), b(dir / "killed" / "simulate.nc");
  EXPECT_EQ(a.doubles("strain"), b.doubles("strain"));
  const NetcdfReader f(dir / "whole" / "fields.exo"), g(dir / "killed" / "fields.exo");
  ASSERT_EQ(f.doubles("time_whole").size(), 31u);
  for (const char* variable :
       {"time_whole", "coordx", "connect1", "vals_nod_var1", "vals_nod_var6", "vals_elem_var1eb2", "vals_elem_var2eb1", "vals_elem_var3eb2"})
    EXPECT_EQ(f.doubles(variable), g.doubles(variable)) << variable;
  const auto whole = calomel::read_json(dir / "whole" / "simulate.json"), killed = calomel::read_json(dir / "killed" / "simulate.json");
  EXPECT_GT(killed["resumed_from_step"].get<int>(), 0);
  for (const char* key : {"steps", "energy_balance_error", "energy_in_J", "dissipated_J", "radiated_J", "greatest_wall_stress_Pa", "greatest_wall_stress_at_m"})
    EXPECT_EQ(whole[key], killed[key]) << key;
}

// Asked to stop it saves where it is, however far off the next checkpoint, and leaves the fields to be gone on with.
TEST(Simulate, StoppedOnRequestItSavesAndResumes) {
  const auto dir = folder();
  ASSERT_EQ(run(dir, "simulate case.toml --fields --out whole").status, 0);
  const auto grown = [part = dir / "killed" / "fields.exo.part"] {  // a third of 25 MB
    std::error_code none;
    const auto size = fs::file_size(part, none);
    return !none && size > 8'000'000;
  };
  const int status = stop_program(start(dir, {"--fields", "--set", "solver.checkpoint=1000.0"}), SIGINT, 1, grown);
  ASSERT_TRUE(status != -1 && WIFEXITED(status)) << "it ended before it could be stopped";
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_TRUE(fs::exists(dir / "killed" / "simulate.checkpoint"));
  const auto last = run(dir, "simulate case.toml --fields --out killed");
  ASSERT_EQ(last.status, 0) << last.said;
  EXPECT_THAT(last.said, HasSubstr("resumes from step"));
  for (const auto& [file, variable] : {std::pair{"simulate.nc", "strain"}, {"fields.exo", "vals_nod_var1"}})
    EXPECT_EQ(NetcdfReader(dir / "whole" / file).doubles(variable), NetcdfReader(dir / "killed" / file).doubles(variable)) << file;
}

// With several conditions those that were finished are kept, in whichever one the run was cut off.
TEST(Simulate, InterruptedInAnyConditionItRepeatsNone) {
  const auto dir = folder();
  std::ofstream(dir / "case.toml", std::ios::app) << R"(
[[condition]]
name = "low"
peak_pressure = 10e6
[[condition]]
name = "middle"
peak_pressure = 20e6
[[condition]]
name = "high"
peak_pressure = 30e6
)";
  const std::string coarser = " --fields --set geometry.element_size=0.001";
  const std::vector<std::string> words{"--fields", "--set", "geometry.element_size=0.001"};
  ASSERT_EQ(run(dir, "simulate case.toml --out whole --set solver.checkpoint=0" + coarser).status, 0);
  const fs::path killed = dir / "killed";
  for (const char* condition : {"0", "1", "2"}) ASSERT_TRUE(kill_after(dir, words, 3, std::string("simulate.checkpoint.") + condition)) << condition;
  EXPECT_FALSE(fs::exists(killed / "simulate.nc"));
  EXPECT_TRUE(fs::exists(killed / "fields.exo"));  // whole since the first condition was

  const auto untouched = fs::last_write_time(killed / "fields.exo");
  const auto last = run(dir, "simulate case.toml --out killed" + coarser);
  ASSERT_EQ(last.status, 0) << last.said;
  EXPECT_THAT(last.said, HasSubstr("condition low is finished and kept"));
  EXPECT_THAT(last.said, HasSubstr("condition middle is finished and kept"));
  EXPECT_THAT(last.said, HasSubstr("condition high resumes from step"));
  EXPECT_EQ(fs::last_write_time(killed / "fields.exo"), untouched);
  for (const char* condition : {"0", "1", "2"}) EXPECT_FALSE(fs::exists(killed / (std::string("simulate.checkpoint.") + condition)));

  const NetcdfReader a(dir / "whole" / "simulate.nc"), b(killed / "simulate.nc");
  EXPECT_EQ(a.doubles("strain"), b.doubles("strain"));
  EXPECT_EQ(NetcdfReader(dir / "whole" / "fields.exo").doubles("vals_nod_var1"), NetcdfReader(killed / "fields.exo").doubles("vals_nod_var1"));
  const auto whole = calomel::read_json(dir / "whole" / "simulate.json"), json = calomel::read_json(killed / "simulate.json");
  for (const char* key : {"steps", "energy_balance_error", "greatest_wall_stress_Pa"}) EXPECT_EQ(whole[key], json[key]) << key;
  // Two of three conditions were not run again.
  EXPECT_GT(json["resumed_from_step"].get<double>(), whole["steps"].get<double>() * 2 / 3);
}

TEST(Simulate, TheFieldsAreContinuedOrTheRunStartsAgain) {
  const auto dir = folder();
  ASSERT_TRUE(kill_after(dir, {"--fields"}, 3));
  fs::remove(dir / "killed" / "fields.exo.part");
  const auto lost = run(dir, "simulate case.toml --fields --out killed");
  EXPECT_EQ(lost.status, 2);
  EXPECT_THAT(lost.said, HasSubstr("gone or broken"));
  const auto fresh = run(dir, "simulate case.toml --fields --out killed --fresh --set time.end=1e-5");
  EXPECT_EQ(fresh.status, 0) << fresh.said;
  EXPECT_TRUE(fs::exists(dir / "killed" / "simulate.checkpoint.old-1"));
}

// The greatest stress and the time at the cutoff are reported with their places, for runs with an energy balance alone.
TEST(Simulate, ReportsTheGreatestWallStressAndTheTimeAtTheCutoff) {
  const auto dir = folder();
  const std::string coarse = "simulate case.toml --fields --set geometry.element_size=0.001 --set time.end=4e-5 --set fields.interval=1e-6";
  ASSERT_EQ(run(dir, coarse + " --out balance").status, 0);
  const auto json = calomel::read_json(dir / "balance" / "simulate.json");
  const double greatest = json["greatest_wall_stress_Pa"];
  const auto at = json["greatest_wall_stress_at_m"].get<std::vector<double>>();
  ASSERT_EQ(at.size(), 3u);
  const NetcdfReader fields(dir / "balance" / "fields.exo");
  const auto times = fields.doubles("time_whole");
  ASSERT_EQ(times.size(), 41u);

  // The pictures, an output interval apart, come near the greatest of all steps, at the same element.
  const auto stress = fields.doubles("vals_elem_var2eb1");
  const auto most = std::max_element(stress.begin(), stress.end());
  EXPECT_LE(*most, greatest * (1 + 1e-6));
  EXPECT_GT(*most, 0.8 * greatest);
  const auto corners = fields.integers("connect1");
  const auto x = fields.doubles("coordx"), z = fields.doubles("coordz");
  const std::size_t elements = corners.size() / 8;
  double nearest = 1, there = 0;
  for (std::size_t e = 0; e < elements; ++e) {
    double dx = -at[0], dz = -at[2];
    for (std::size_t k = 0; k < 8; ++k) dx += x[std::size_t(corners[8 * e + k] - 1)] / 8, dz += z[std::size_t(corners[8 * e + k] - 1)] / 8;
    if (std::hypot(dx, dz) > nearest) continue;
    nearest = std::hypot(dx, dz);
    there = 0;
    for (std::size_t t = 0; t < times.size(); ++t) there = std::max(there, stress[t * elements + e]);
  }
  EXPECT_LT(nearest, 1e-6);
  EXPECT_GT(there, 0.8 * greatest);

  // Time at the cutoff never falls, grows no faster than the clock, and is 0 in the steel; the pressure there is that of the cutoff.
  const auto cutoff = fields.doubles("vals_elem_var3eb2"), pressure = fields.doubles("vals_elem_var1eb2");
  const std::size_t liquid = cutoff.size() / times.size();
  std::size_t grown = 0, held = 0;
  for (std::size_t t = 1; t < times.size(); ++t)
    for (std::size_t e = 0; e < liquid; ++e) {
      const double grows = cutoff[t * liquid + e] - cutoff[(t - 1) * liquid + e];
      EXPECT_GE(grows, 0);
      EXPECT_LE(grows, (times[t] - times[t - 1]) * 1.001);
      if (grows < 0.999 * (times[t] - times[t - 1])) continue;
      ++grown;
      held += std::abs(pressure[t * liquid + e] + 1.5e5) < 1e3;
    }
  EXPECT_GT(grown, 100u);
  EXPECT_GT(double(held), 0.95 * double(grown));
  for (const double v : fields.doubles("vals_elem_var3eb1")) EXPECT_EQ(v, 0);

  ASSERT_EQ(run(dir, coarse + " --out bare --set solver.energy_balance=false").status, 0);
  const auto bare = calomel::read_json(dir / "bare" / "simulate.json");
  EXPECT_TRUE(bare["energy_balance_error"].is_null());
  EXPECT_FALSE(bare.contains("greatest_wall_stress_Pa"));
  EXPECT_FALSE(NetcdfReader(dir / "bare" / "fields.exo").has("vals_elem_var3eb2"));
}

// The run uses the numbers of the tables: another nominal value gives a warning, and one set by --set is refused.
TEST(Simulate, ANominalValueWithoutEffectIsReportedWithTheKeyThatHasOne) {
  const auto dir = folder_with("nominal", {{"case.toml", slice_case + "[parameter.density]\nmin = 13000.0\nmax = 13600.0\n"}});
  const auto set = run(dir, "simulate case.toml --out set --set parameter.density.nominal=13100.0");
  EXPECT_EQ(set.status, 2);
  for (const char* part :
       {"--set parameter.density.nominal=13100", "parameter.density.nominal = 13100", "has no effect", "--set material.mercury.density=13100"})
    EXPECT_THAT(set.said, HasSubstr(part));
  EXPECT_FALSE(fs::exists(dir / "set" / "simulate.nc"));
  // In the file it may be meant for other stages: a warning with its place, and the run.
  std::ofstream(dir / "case.toml", std::ios::app) << "nominal = 13100.0\n";
  const auto warned = run(dir, "simulate case.toml --out warned");
  EXPECT_EQ(warned.status, 0) << warned.said;
  EXPECT_THAT(warned.said, ::testing::ContainsRegex("warning: .*case.toml:[0-9]+.*parameter.density.nominal = 13100.*no effect"));
  // Controls: the key that is named has an effect and needs no warning; the same number as in the table is none either.
  const auto other = run(dir, "simulate case.toml --out other --set material.mercury.density=13100.0");
  EXPECT_EQ(other.status, 0) << other.said;
  EXPECT_THAT(other.said, ::testing::Not(HasSubstr("no effect")));
  EXPECT_NE(NetcdfReader(dir / "warned" / "simulate.nc").doubles("strain"), NetcdfReader(dir / "other" / "simulate.nc").doubles("strain"));
  EXPECT_EQ(run(dir, "simulate case.toml --out same --set parameter.density.nominal=13500.0").status, 0);
}
