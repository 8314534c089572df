// Cases of a line through the command line: check, simulate, list, and what is refused.
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/netcdf_file.hpp"
#include "tests/regression/slice_case.hpp"

using namespace calomel::testing;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

const std::string pipe_case = R"([case]
name = "hammer"
sensor_unit = "kPa"
[model]
kind = "line"
[line]
kind = "pipe"
length = 40
diameter = 0.02
wave_speed = 1250
density = 1000
velocity = 0.5
reservoir_pressure = 200e3
friction_factor = 0.02
cells = 32
[time]
end = 0.064
output_interval = 0.001
[[station]]
name = "valve"
distance = 40
[mechanism.vapour_cutoff]
enabled = true
pressure = -99e3
[parameter.wave_speed]
min = 1100
max = 1400
)";

const std::string bar_case = R"([model]
kind = "line"
[line]
kind = "bar"
wave_speed = 5000
[drive]
file = "record.txt"
[time]
end = 6e-5
output_interval = 1e-6
[[station]]
name = "far"
distance = 0.1
)";

std::string record() {
  std::string text = "time strain\n";
  for (int i = 0; i <= 50; ++i) text += std::to_string(i) + "e-6 " + (i == 10 ? "1" : "0") + '\n';
  return text;
}

}  // namespace

TEST(Line, OfAPipeIsCheckedAndSimulated) {
  const auto dir = folder_with("line_pipe", {{"case.toml", pipe_case}});
  const auto told = printed(dir, "check case.toml");
  EXPECT_EQ(told.status, 0);
  for (const char* part :
       {"case: hammer, waves along a pipe", "32 cells, 64 steps of 0.001 s, 1 stations at 65 times, readings in kPa", "rho a V 625 kPa, period 4 L / a 0.128 s",
        "mechanisms: vapour_cutoff; offered to a diagnosis: unsteady_friction, wall_viscoelasticity, sensor_response", "parameters: wave_speed 1100 to 1400"})
    EXPECT_THAT(told.said, HasSubstr(part));
  EXPECT_THAT(printed(dir, "check case.toml --resolved").said, HasSubstr("\"closure_exponent\": 1.0"));
  const auto made = run(dir, "simulate case.toml");
  ASSERT_EQ(made.status, 0) << made.said;
  const calomel::NetcdfReader file(dir / "case.out" / "simulate.nc");
  EXPECT_THAT(file.shape("strain"), ElementsAre(1u, 65u));
  EXPECT_THAT(file.strings("sensor"), ElementsAre("valve"));
  EXPECT_EQ(file.attribute("unit"), "kPa");
  EXPECT_NEAR(file.doubles("strain")[1], 195 + 625, 1);  // 5 kPa of friction
  const auto summary = calomel::read_json(dir / "case.out" / "simulate.json");
  EXPECT_EQ(summary["elements"], 32);
  EXPECT_EQ(summary["nodes"], 33);
  EXPECT_EQ(summary["steps"], 64);
  EXPECT_TRUE(summary["energy_balance_error"].is_null());
  for (const char* key : {"time_step_s", "wall_s", "element_steps_per_s"}) EXPECT_GT(summary[key].get<double>(), 0) << key;
}

TEST(Line, OfABarTakesItsRecordFromTheFolderOfTheCase) {
  const auto dir = folder_with("line_bar", {{"case.toml", bar_case}, {"record.txt", record()}});
  const auto made = run(dir, "simulate case.toml");
  ASSERT_EQ(made.status, 0) << made.said;
  const auto strain = calomel::NetcdfReader(dir / "case.out" / "simulate.nc").doubles("strain");
  EXPECT_NEAR(strain[30], 1, 1e-9);  // 20 us later
  EXPECT_NEAR(strain[29], 0, 1e-9);
}

TEST(Line, TellsWhereACaseIsWrong) {
  const auto said = [](const std::string& text, const std::string& words = "check case.toml") {
    const auto out = run(folder_with("line_wrong", {{"case.toml", text}, {"record.txt", record()}}), words);
    EXPECT_EQ(out.status, 2) << out.said;
    return out.said;
  };
  EXPECT_THAT(said("[model]\nkind = \"lime\"\n"), HasSubstr("case.toml:2:1: model.kind = \"lime\""));
  EXPECT_THAT(said("[model]\nkind = \"lime\"\n"), HasSubstr("did you mean \"line\"?"));
  EXPECT_THAT(said(bar_case + "[mechanism.lateral_inertia]\nenabled = true\npoisson = 0.29\n"), HasSubstr("set line.radius"));
  EXPECT_THAT(said(bar_case + "[mechanism.lateral_inertia]\npoisson = 0.6\n"), HasSubstr("(allowed: 0 <= x <= 0.49)"));
  EXPECT_THAT(said(slice_case + "[line]\nkind = \"bar\"\n"), HasSubstr("line: this table belongs to a line"));
  EXPECT_THAT(said(pipe_case, "campaign case.toml"), HasSubstr("a line is only checked and simulated in this version, not: campaign"));
  EXPECT_THAT(said(pipe_case, "simulate case.toml --mean"), HasSubstr("--mean"));
}

TEST(Line, HasItsMechanismsListed) {
  const auto out = printed(folder_with("line_list", {}), "list");
  for (const char* part : {"mechanisms of a bar", "lateral_inertia", "mechanisms of a pipe", "vapour_cutoff"}) EXPECT_THAT(out.said, HasSubstr(part));
}
