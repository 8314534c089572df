// Malformed input through the program as a user meets it: exit status 2, the place, the key, the value, and what to do.
#include "tests/regression/slice_case.hpp"

using namespace calomel::testing;

namespace {

const std::string good = slice_case + R"([[sensor]]
name = "B"
position = [0.04, 0.0, 0.0]
direction = [1, 0, 0]
[recordings]
file = "recordings.csv"
[parameter.density]
min = 13000.0
max = 13600.0
[parameter.sound_speed]
min = 1400.0
max = 1500.0
[campaign]
runs = 4
[enc]
rounds = 4
)";

std::string good_records() {
  std::string s = "sensor,pulse,time,strain\n";
  for (const char* sensor : {"A", "B"})
    for (int pulse = 0; pulse < 3; ++pulse)
      for (int k = 0; k <= 20; ++k)
        s += std::string(sensor) + ',' + std::to_string(pulse) + ',' + std::to_string(k) + "e-6," + std::to_string(1e-6 * k * (pulse + 1)) + '\n';
  return s;
}

struct Edit {
  std::string name;                ///< of the test
  std::string old, now;            ///< the line's change; empty `old`: in the recordings instead
  std::vector<std::string> words;  ///< all must be said
  std::string place;               ///< "case.toml:7", "recordings.csv:4"
  std::string verb = "check";
  std::string records;  ///< whole recordings, when not the good ones
};

void PrintTo(const Edit& edit, std::ostream* out) { *out << edit.name; }

std::filesystem::path write_case(const Edit& e) {
  return folder_with("malformed_" + e.name,
                     {{"case.toml", e.old.empty() ? good : with(good, e.old, e.now)}, {"recordings.csv", e.records.empty() ? good_records() : e.records}});
}

std::vector<Edit> edits() {
  const std::string r = good_records();
  return {
      {"misspelt_key", "peak_pressure", "peak_presure", {"peak_presure", "peak_pressure"}, "case.toml:24"},
      {"misspelt_table", "[time]", "[tiem]", {"tiem", "time"}, "case.toml:27"},
      {"negative_young", "young = 193e9", "young = -193e9", {"young", "-1.93e+11", "Pa"}, "case.toml:15"},
      {"incompressible_steel", "poisson = 0.29", "poisson = 0.5", {"poisson", "0.5", "0.49"}, "case.toml:16"},
      {"text_for_number", "height = 0.04", "height = \"high\"", {"height", "number"}, "case.toml:8"},
      {"number_for_text", "kind = \"box\"", "kind = 3", {"kind", "text"}, "case.toml:5"},
      {"unknown_kind", "kind = \"box\"", "kind = \"bocks\"", {"bocks", "box", "jet_flow"}, "case.toml:5"},
      {"unknown_law", "law = \"riemer\"", "law = \"rimer\"", {"rimer", "riemer"}, "case.toml:18"},
      {"unclosed_table", "[load]", "[load", {"TOML"}, "case.toml:22"},
      {"duplicate_key", "density = 7960.0", "density = 7960.0\ndensity = 1.0", {"density"}, "case.toml:15"},
      {"walls_fill_the_box", "wall = 0.004", "wall = 0.03", {"wall", "0.03"}, "case.toml:9"},
      {"no_element_size", "element_size = 0.002\n", "", {"element_size"}, "case.toml:4"},
      {"vanishing_element_size", "element_size = 0.002", "element_size = 1e-9", {"element_size", "1e-09"}, "case.toml:12"},
      {"end_between_samples", "end = 2e-5", "end = 2.05e-5", {"time.end", "output_interval"}, "case.toml:28"},
      {"negative_end", "end = 2e-5", "end = -2e-5", {"time.end"}, "case.toml:28"},
      {"no_strength", "peak_pressure = 25e6\n", "", {"peak_pressure", "energy"}, "case.toml:"},
      {"two_strengths", "pulse_length = 0.7e-6", "pulse_length = 0.7e-6\nenergy = 1e4", {"energy", "peak_pressure"}, "case.toml:"},
      {"short_list", "center = [0.0, 0.02]", "center = [0.0]", {"center", "2 numbers"}, "case.toml:26"},
      {"sensor_in_the_air", "position = [0.02, 0.0, 0.04]", "position = [0.02, 0.0, 0.09]", {"A", "position"}, "case.toml:32"},
      {"sensor_normal_to_wall", "direction = [1, 0, 0]", "direction = [0, 0, 1]", {"A", "direction"}, "case.toml:33"},
      {"sensor_twice", "name = \"B\"", "name = \"A\"", {"A", "same name"}, "case.toml:35"},
      {"bounds_crossed", "max = 13600.0", "max = 12000.0", {"max", "12000"}, "case.toml:42"},
      {"parameter_of_nothing", "[parameter.sound_speed]", "[parameter.soundspeed]", {"soundspeed", "sound_speed"}, "case.toml:43"},
      {"parameter_of_the_file_of_draws",
       "[parameter.sound_speed]",
       "[parameter.draw]\nkey = \"material.mercury.sound_speed\"",
       {"draw", "posterior.nc", "another name"},
       "case.toml:"},
      {"parameter_with_a_slash", "[parameter.sound_speed]", "[parameter.\"c/c0\"]\nkey = \"material.mercury.sound_speed\"", {"c/c0", "letters"}, "case.toml:"},
      {"bound_that_cannot_be",
       "max = 13600.0",
       "max = 13600.0\n[parameter.tensile_cutoff]\nmin = -1e5\nmax = 2e5",
       {"parameter.tensile_cutoff.min", "-100000", "Pa", ">= 0"},
       "case.toml:44"},
      {"odd_walkers",
       "[campaign]",
       "[sampler]\nkind = \"ensemble\"\n[sampler.ensemble]\nwalkers = 7\n[campaign]",
       {"sampler.ensemble.walkers", "7", "even"},
       "case.toml:49"},
      {"mechanism_of_no_wall", "[campaign]", "[mechanism.interface]\nwall = \"lid\"\n[campaign]", {"mechanism.interface.wall", "lid", "front"}, "case.toml:47"},
      {"unknown_mechanism", "[campaign]", "[mechanism.bubly_liquid]\n[campaign]", {"bubly_liquid", "bubbly_liquid"}, "case.toml:46"},
      {"unknown_design", "runs = 4", "design = \"sobl\"", {"sobl", "sobol"}, "case.toml:47"},
      {"fractional_runs", "runs = 4", "runs = 4.5", {"runs", "whole number"}, "case.toml:47"},
      {"unknown_optimiser", "rounds = 4", "optimizers = [\"de\", \"gwoo\"]", {"gwoo", "gwo"}, "case.toml:49"},
      {"recordings_absent", "file = \"recordings.csv\"", "file = \"recs.csv\"", {"recs.csv"}, "case.toml:39"},
      {"record_text", "", "", {"abc"}, "recordings.csv:3", "check", with(r, "A,0,1e-6,0.000001", "A,0,1e-6,abc")},
      {"record_columns", "", "", {"columns"}, "recordings.csv:3", "check", with(r, "A,0,1e-6,0.000001", "A,0,1e-6")},
      {"record_unknown_sensor", "", "", {"C", "case.toml"}, "recordings.csv:3", "check", with(r, "A,0,1e-6,0.000001", "C,0,1e-6,0.000001")},
      {"record_twice", "", "", {"A"}, "recordings.csv:4", "check", with(r, "A,0,2e-6", "A,0,1e-6")},
      {"record_empty", "", "", {}, "recordings.csv", "check", "sensor,pulse,time,strain\n"},
  };
}

class MalformedInput : public testing::TestWithParam<Edit> {};

}  // namespace

TEST(WellFormedInput, IsAccepted) {
  const auto out = run(write_case({"good", "", "", {}, ""}), "check case.toml");
  EXPECT_EQ(out.status, 0) << out.said;
}

TEST_P(MalformedInput, ExitsTwoWithAMessageThatNamesTheMistakeAndTheRemedy) {
  const Edit& e = GetParam();
  const auto out = run(write_case(e), e.verb + " case.toml");
  EXPECT_EQ(out.status, 2) << out.said;
  EXPECT_THAT(out.said, testing::HasSubstr(e.place));
  for (const auto& w : e.words) EXPECT_THAT(out.said, testing::HasSubstr(w));
  EXPECT_LT(out.said.size(), 2000u);
}

INSTANTIATE_TEST_SUITE_P(Cases, MalformedInput, testing::ValuesIn(edits()), [](const auto& info) { return info.param.name; });

// A sampler that cannot sample this case is refused before the first request to the model: there is no server at this address.
TEST(WellFormedInput, IsRefusedBeforeAnyRunIfTheSamplerCannotSampleTheModel) {
  const auto dir =
      folder_with("sampler_of_log_density",
                  {{"case.toml",
                    "[model]\nkind = \"umbridge\"\nurl = \"http://127.0.0.1:1\"\nname = \"m\"\n[parameter.a]\nmin = 0\nmax = 1\nprior = \"uniform\"\n"
                    "[output]\nkind = \"log_density\"\n[sampler]\nkind = \"delayed_acceptance\"\n"}});
  const auto refused = run(dir, "sample case.toml");
  EXPECT_EQ(refused.status, 2);
  for (const char* part : {"case.toml:12", "sampler.kind", "emulator", "take \"dram\""}) EXPECT_THAT(refused.said, testing::HasSubstr(part));
}

TEST(CommandLine, RefusesUnknownWords) {
  const auto dir = write_case({"line", "", "", {}, ""});
  EXPECT_EQ(run(dir, "simulat case.toml").status, 2);
  EXPECT_THAT(run(dir, "simulat case.toml").said, testing::HasSubstr("simulate"));
  EXPECT_EQ(run(dir, "simulate case.toml --thread 2").status, 2);
  EXPECT_EQ(run(dir, "simulate absent.toml").status, 2);
  EXPECT_EQ(run(dir, "check case.toml --set geometry.elment_size=1").status, 2);
  EXPECT_THAT(run(dir, "check case.toml --set geometry.elment_size=1").said, testing::HasSubstr("element_size"));
}
