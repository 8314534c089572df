// Cases of a line through the command line: check, simulate, list, and what is refused.
#include <fmt/format.h>

#include <cmath>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/netcdf_file.hpp"
#include "base/random.hpp"
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

/// Two gauges of a bar, 200 us apart; the second lags by 4 us.
std::string two_gauges() {
  calomel::RandomStream noise(1, 0);
  const auto pulse = [](double us) { return us > 20 && us < 90 ? std::pow(std::sin(M_PI * (us - 20) / 70), 2) : 0.0; };
  std::string text = "time,first,second\n";
  double lagging = 0;
  constexpr int fine = 20;
  for (int i = 0; i <= 350; ++i) {
    text += fmt::format("{}e-6,{:.6f},{:.6f}\n", i, pulse(i), lagging + 1e-3 * noise.normal());
    for (int k = 0; k < fine; ++k) lagging += (pulse(i + (k + 0.5) / fine - 200) - lagging) / fine / 4;
  }
  return text;
}

const std::string lag_case = R"([case]
sensor_unit = "V"
[model]
kind = "line"
[line]
kind = "bar"
wave_speed = 5000
[drive]
file = "record.csv"
[time]
end = 3.4e-4
output_interval = 1e-6
[[station]]
name = "second"
distance = 1.0
[recordings]
file = "record.csv"
unit = "V"
exclude = ["first"]
begin = 2e-4
end = 3.4e-4
noise = 1e-3
[parameter.wave_speed]
min = 4500
max = 5500
prior = "normal"
mean = 5000
sd = 20
[parameter.gain]
key = "station.second.gain"
min = 0.8
max = 1.2
prior = "normal"
mean = 1
sd = 0.02
[errors]
band = 2e5
[mechanism.sensor_response]
[mechanism.viscous_attenuation]
)";

}  // namespace

TEST(Line, OfAPipeIsCheckedAndSimulated) {
  const auto dir = folder_with("line_pipe", {{"case.toml", pipe_case}});
  const auto result = printed(dir, "check case.toml");
  EXPECT_EQ(result.status, 0);
  for (const char* part :
       {"case: hammer, waves along a pipe", "32 cells, 64 steps of 0.001 s, 1 stations at 65 times, readings in kPa", "rho a V 625 kPa, period 4 L / a 0.128 s",
        "mechanisms: vapour_cutoff; offered to a diagnosis: unsteady_friction, wall_viscoelasticity, sensor_response", "parameters: wave_speed 1100 to 1400"})
    EXPECT_THAT(result.said, HasSubstr(part));
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

TEST(Line, ReportsThePlaceOfAMistakeInTheCase) {
  const auto said = [](const std::string& text, const std::string& words = "check case.toml") {
    const auto out = run(folder_with("line_wrong", {{"case.toml", text}, {"record.txt", record()}}), words);
    EXPECT_EQ(out.status, 2) << out.said;
    return out.said;
  };
  EXPECT_THAT(said("[model]\nkind = \"lime\"\n"), HasSubstr("case.toml:2:1: model.kind = \"lime\""));
  EXPECT_THAT(said("[model]\nkind = \"lime\"\n"), HasSubstr("did you mean \"line\"?"));
  EXPECT_THAT(said(bar_case + "[mechanism.lateral_inertia]\nenabled = true\npoisson = 0.29\n"), HasSubstr("set line.radius"));
  EXPECT_THAT(said(bar_case + "[mechanism.lateral_inertia]\npoisson = 0.6\n"), HasSubstr("(allowed: 0 <= x <= 0.49)"));
  EXPECT_THAT(said(slice_case + "[line]\nkind = \"bar\"\n"), HasSubstr("line: this table belongs to a model of kind \"line\""));
  EXPECT_THAT(said(pipe_case, "simulate case.toml --mean"), HasSubstr("--mean"));
}

TEST(Line, HasCampaignsAndSurrogatesAsAnyModel) {
  const auto dir = folder_with("line_campaign", {{"case.toml", pipe_case}, {"record.txt", record()}});
  const auto out = run(dir, "train case.toml --set campaign.runs=12");
  EXPECT_EQ(out.status, 0) << out.said;
  EXPECT_THAT(out.said, HasSubstr("12 of 12 runs completed"));
  EXPECT_TRUE(std::filesystem::exists(dir / "case.out" / "surrogate.nc"));
}

TEST(Line, RecordsAreInTheUnitOfTheModel) {
  const auto dir = folder_with("line_unit", {{"case.toml", with(lag_case, "file = \"record.csv\"\nunit = \"V\"", "file = \"record.csv\"\nunit = \"mV\"")},
                                             {"record.csv", two_gauges()}});
  const auto out = run(dir, "check case.toml");
  EXPECT_EQ(out.status, 2);
  EXPECT_THAT(out.said, HasSubstr("recordings.unit = \"mV\": the model's values are in V"));
}

TEST(Line, IsDiagnosedAndReported) {
  const auto dir = folder_with("line_diagnosed", {{"case.toml", lag_case}, {"record.csv", two_gauges()}});
  const auto made = run(dir, "diagnose case.toml");
  ASSERT_EQ(made.status, 0) << made.said;
  EXPECT_THAT(made.said, HasSubstr("verdict: named sensor_response"));
  const auto d = calomel::read_json(dir / "case.out" / "diagnosis.json");
  EXPECT_EQ(d["verdict"], "named");
  EXPECT_EQ(d["status"], "done");
  EXPECT_EQ(d["fit"]["before"]["unit"], "V");
  EXPECT_GT(d["fit"]["before"]["residual_rms"].get<double>(), 4e-3);
  EXPECT_LT(d["fit"]["after"]["residual_rms"].get<double>(), 1.2e-3);
  EXPECT_LT(d["fit"]["after"]["heldout_nrmse"].get<double>(), 0.3 * d["fit"]["before"]["heldout_nrmse"].get<double>());
  double sum = 0, lag = 0;
  for (const auto& r : d["ranking"]) {
    sum += r["probability"].get<double>();
    if (r["name"] != "sensor_response") continue;
    for (const auto& p : r["parameters"])
      if (p["name"] == "sensor_response.lag") lag = p["mean"];
  }
  EXPECT_NEAR(sum, 1, 1e-9);
  EXPECT_NEAR(lag, 4e-6, 1.2e-6);  // a low pass and the speed do part of it
  EXPECT_THAT(run(dir, "diagnose case.toml").said, HasSubstr("reused"));
  const auto page = run(dir, "report case.toml --csv");
  ASSERT_EQ(page.status, 0) << page.said;
  const auto html = calomel::read_text(dir / "case.out" / "report.html");
  for (const char* part : {"Physics that the simulation omits", "sensor_response", "wave_speed", "neither a surface nor the places of its sensors"})
    EXPECT_THAT(html, HasSubstr(part));
}

TEST(Line, AnInterruptedDiagnosisEndsWithTheSameResult) {
  const auto whole = folder_with("line_whole", {{"case.toml", lag_case}, {"record.csv", two_gauges()}}),
             cut = folder_with("line_cut", {{"case.toml", lag_case}, {"record.csv", two_gauges()}});
  ASSERT_EQ(run(whole, "diagnose case.toml").status, 0);
  const auto journal = cut / "case.out" / "runs.journal";
  int kills = 0;
  for (const std::uintmax_t after : {200'000u, 600'000u})
    kills += WIFSIGNALED(stop_program(start_program(cut, {"diagnose", "case.toml", "--quiet"}), SIGKILL, 1, [&] {
      std::error_code none;
      return std::filesystem::exists(journal) && std::filesystem::file_size(journal, none) > after;
    }));
  EXPECT_EQ(kills, 2);
  EXPECT_FALSE(std::filesystem::exists(cut / "case.out" / "diagnosis.json"));
  ASSERT_EQ(run(cut, "diagnose case.toml").status, 0);
  auto again = calomel::read_json(cut / "case.out" / "diagnosis.json"), once = calomel::read_json(whole / "case.out" / "diagnosis.json");
  again.erase("wall_s");
  once.erase("wall_s");
  EXPECT_EQ(again, once);
}

TEST(Line, ADiagnosisListsItsMissingInputs) {
  const auto said = [](const std::string& text) {
    const auto out = run(folder_with("line_needs", {{"case.toml", text}, {"record.csv", two_gauges()}}), "diagnose case.toml");
    EXPECT_EQ(out.status, 2) << out.said;
    return out.said;
  };
  EXPECT_THAT(said(with(lag_case, "noise = 1e-3\n", "")), HasSubstr("recordings.noise"));
  EXPECT_THAT(said(with(lag_case, "band = 2e5", "band = 2e3")), HasSubstr("errors.discrepancy_times"));
  EXPECT_THAT(said(with(lag_case, "prior = \"normal\"\nmean = 5000\nsd = 20\n", "")), HasSubstr("parameter.wave_speed.prior"));
  std::string none = lag_case;
  none.erase(none.find("[parameter.wave_speed]"), none.find("[errors]") - none.find("[parameter.wave_speed]"));
  EXPECT_THAT(said(none), HasSubstr("no numbers that may move"));
}

TEST(Line, HasItsMechanismsListed) {
  const auto out = printed(folder_with("line_list", {}), "list");
  for (const char* part : {"Mechanisms of a bar", "lateral_inertia", "Mechanisms of a pipe", "vapour_cutoff"}) EXPECT_THAT(out.said, HasSubstr(part));
}
