// `calomel sample` as a whole: the truth within the posterior, artefacts to the contract, and the same draws after a kill.
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/netcdf_file.hpp"
#include "tests/regression/slice_case.hpp"

using namespace calomel::testing;
using calomel::Json;
using calomel::NetcdfReader;
using calomel::read_json;
using calomel::read_text;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

namespace {

constexpr double true_density = 13310, true_speed = 1462;

const std::string tables = R"([[sensor]]
name = "F"
position = [0.0, 0.0, 0.02]
direction = [0, 0, 1]
[parameter.density]
min = 12000
max = 14500
[parameter.sound_speed]
min = 1300
max = 1600
[campaign]
pulses = 2
[emulator]
element_sizes = [0.002, 0.001]
viscosity_sd = 0
start = "nominal"
coarse_runs = 32
fine_runs = 16
round_coarse = 3
round_fine = 2
check_coarse = 2
check_fine = 2
[errors]
band = 1e5
young_sd = 0
wall_film_sd = 0
beyond = 0
beyond_sd = 0.1
beyond_rest = 0.2
[sampler]
warmup = 2000
draws = 4000
)";

/// A folder whose records are the ensemble mean of the finest mesh at the true values.
fs::path folder(const std::string& name) {
  const auto dir = folder_with(name, {{"case.toml", with(slice_case, "end = 2e-5", "end = 6e-5") + tables}});
  const auto made = run(dir, "simulate case.toml --mean --out truth --set material.mercury.density=" + std::to_string(true_density) +
                                 " --set material.mercury.sound_speed=" + std::to_string(true_speed) +
                                 " --set geometry.element_size=0.001 --set material.mercury.least_mesh_viscosity=0");
  EXPECT_EQ(made.status, 0) << made.said;
  put_records(dir);
  return dir;
}

std::string line_of(const std::vector<std::string>& words) {
  std::string line;
  for (const auto& w : words) line += ' ' + w;
  return line;
}

/// The posterior of `dir`/whole by a program that is killed when its journal has these shares of the whole one's size, one after another, and then ends by
/// itself.
void goes_on_to_the_same_draws(const fs::path& dir, const std::vector<std::string>& options, const std::vector<double>& shares) {
  const fs::path journal = dir / "killed" / "runs.journal";
  const auto size = double(fs::file_size(dir / "whole" / "runs.journal"));
  std::vector<std::string> words{"sample", "case.toml", "--out", "killed", "--quiet", "--threads", "1"};
  words.insert(words.end(), options.begin(), options.end());
  for (const double share : shares) {
    const int status = stop_program(start_program(dir, words), SIGKILL, 1, [&] {
      std::error_code none;
      const auto now = fs::file_size(journal, none);
      return !none && double(now) > share * size;
    });
    ASSERT_TRUE(status != -1 && WIFSIGNALED(status)) << "it ended before it could be killed";
  }
  EXPECT_FALSE(fs::exists(dir / "killed" / "posterior.json"));
  const auto last = run(dir, "sample case.toml --out killed --threads 2" + line_of(options));
  ASSERT_EQ(last.status, 0) << last.said;
  EXPECT_EQ(read_text(dir / "killed" / "posterior.nc"), read_text(dir / "whole" / "posterior.nc"));
}

}  // namespace

TEST(SampleVerb, FindsTheTruthAndWritesAllKeysOfTheContract) {
  const auto dir = folder("sample");
  const auto first = run(dir, "sample case.toml --out a");
  ASSERT_EQ(first.status, 0) << first.said;
  const Json json = read_json(dir / "a" / "posterior.json");
  EXPECT_EQ(json["status"], "done");
  EXPECT_TRUE(json["converged"].get<bool>());
  EXPECT_TRUE(json["true_model_check"]["holds"].get<bool>());
  EXPECT_EQ(json["final"], json["converged"].get<bool>() && json["warnings"].empty() && json["absorption"].empty());
  EXPECT_TRUE(json["adequate"].get<bool>());
  for (const char* key : {"final", "product", "mode", "absorption", "runs", "sampler", "provenance", "refinement", "hyperparameters", "regions", "adequacy"})
    EXPECT_TRUE(json.contains(key)) << key;
  ASSERT_EQ(json["parameters"].size(), 3u);  // the two, and how far past the finest mesh
  for (const char* key : {"name", "mean", "sd", "q05", "q50", "q95", "r_hat", "ess_bulk", "ess_tail", "mcse_mean"})
    EXPECT_TRUE(json["parameters"][0].contains(key)) << key;
  const std::array<double, 2> truth{true_density, true_speed};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto& p = json["parameters"][k];
    EXPECT_LT(std::abs(p["mean"].get<double>() - truth[k]), 3 * p["sd"].get<double>()) << p["name"];
    EXPECT_LT(p["sd"].get<double>(), 0.05 * truth[k]) << p["name"];
    // Laplace's deviation beside that of the chains.
    const double laplace = json["mode"]["sd"][p["name"].get<std::string>()];
    EXPECT_NEAR(laplace / p["sd"].get<double>(), 1, 0.4) << p["name"];
  }
  EXPECT_EQ(json["refinement"]["made"], 0);
  EXPECT_THAT(first.said, Not(HasSubstr("was refined")));
  EXPECT_EQ(json["hyperparameters"]["draws"], 6);
  for (const auto& ratio : json["hyperparameters"]["sd_ratio"]) EXPECT_NEAR(ratio.get<double>(), 1, 0.5);
  EXPECT_THAT(first.said, HasSubstr(json["hyperparameters"]["sentence"].get<std::string>()));
  EXPECT_EQ(json["regions"]["parameters"], Json({"density", "sound_speed"}));
  EXPECT_FALSE(json.contains("compared"));
  const NetcdfReader file(dir / "a" / "posterior.nc");
  EXPECT_EQ(file.shape("posterior/density"), (std::vector<std::size_t>{4, 4000}));
  EXPECT_EQ(file.dimensions("posterior/density"), (std::vector<std::string>{"chain", "draw"}));
  for (const char* variable : {"sample_stats/lp", "log_likelihood/records", "posterior_predictive/strain", "observed_data/strain", "prior/density"})
    EXPECT_TRUE(file.has(variable)) << variable;
  EXPECT_FALSE(fs::exists(dir / "a" / "posterior.journal"));

  const auto again = run(dir, "sample case.toml --out a");
  EXPECT_EQ(again.status, 0);
  EXPECT_THAT(again.said, HasSubstr("sample: reused"));
  // Another prior is another posterior, of the same runs.
  const auto other = run(dir, "sample case.toml --out a --set parameter.density.prior=normal --set parameter.density.mean=13300 --set parameter.density.sd=30");
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.said, HasSubstr("parameter.density"));
  const auto fresh =
      run(dir, "sample case.toml --out a --fresh --set parameter.density.prior=normal --set parameter.density.mean=13300 --set parameter.density.sd=30");
  EXPECT_EQ(fresh.status, 0) << fresh.said;
  EXPECT_GE(read_json(dir / "a" / "posterior.json")["runs"]["reused"].get<int>(), 24);
  EXPECT_LT(read_json(dir / "a" / "posterior.json")["parameters"][0]["sd"].get<double>(), 31);
}

// A wrong clock shifts the result without any sign in the chains. A data check reports it, and a prior of the trigger includes it.
TEST(SampleVerb, LateRecordsAreReportedAndAPriorOfTheTriggerIncludesThem) {
  const auto dir = folder("sample_late");
  const auto shifted = run(dir, "sample case.toml --out late --set recordings.trigger_offset=-1e-6");
  EXPECT_THAT(shifted.said, HasSubstr("µs late (log Bayes factor"));
  const Json late = read_json(dir / "late" / "posterior.json");
  EXPECT_FALSE(late["final"].get<bool>());
  EXPECT_THAT(late["warnings"].dump(), AllOf(HasSubstr("All records look"), HasSubstr("the fit is not adequate")));
  EXPECT_FALSE(late["adequate"].get<bool>());
  const auto with_clock = run(dir, "sample case.toml --out clock --set recordings.trigger_offset=-1e-6 --set errors.trigger_sd=1e-6");
  ASSERT_EQ(with_clock.status, 0) << with_clock.said;
  const Json json = read_json(dir / "clock" / "posterior.json");
  EXPECT_THAT(json["warnings"].dump(), Not(HasSubstr("All records look")));
  const std::array<double, 2> truth{true_density, true_speed};
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_LT(std::abs(json["parameters"][k]["mean"].get<double>() - truth[k]), 3 * json["parameters"][k]["sd"].get<double>()) << json["parameters"][k];
  // Sound speed makes up for the clock where that is taken for known.
  EXPECT_GT(std::abs(late["parameters"][1]["mean"].get<double>() - true_speed), 3 * late["parameters"][1]["sd"].get<double>());
}

// A gauge of the other sign shifts the fit away from all records. The data check finds it by the runs that most gauges resemble.
TEST(SampleVerb, AGaugeOfTheOtherSignIsReportedAlthoughItSpoilsTheFit) {
  const auto dir = folder("sample_sign");
  const std::string text = with(read_text(dir / "case.toml"), "name = \"F\"", "name = \"F\"\ngain = -1");
  std::ofstream(dir / "case.toml") << text;
  const auto out = run(dir, "sample case.toml --out a --set emulator.rounds=2");
  EXPECT_THAT(out.said, HasSubstr("The record of gauge F has the opposite sign of its simulation"));
  EXPECT_FALSE(read_json(dir / "a" / "posterior.json")["final"].get<bool>());
}

TEST(SampleVerb, InterruptedBetweenRunsItResumesToTheSameDraws) {
  const auto dir = folder("sample_killed");
  ASSERT_EQ(run(dir, "sample case.toml --out whole").status, 0);
  goes_on_to_the_same_draws(dir, {}, {0.05, 0.4});
}

// Few rounds and a check of many runs: the true model differs from the emulator, which is then trained again. Killed once and again while that goes
// on.
TEST(SampleVerb, InterruptedInARefinementItResumesToTheSameDraws) {
  const auto dir = folder("sample_killed_refining");
  const std::vector<std::string> options{"--set", "emulator.rounds=1",      "--set", "emulator.check_coarse=16",
                                         "--set", "emulator.check_fine=16", "--set", "recordings.noise=4e-5"};
  const auto whole = run(dir, "sample case.toml --out whole" + line_of(options));
  ASSERT_EQ(whole.status, 0) << whole.said;
  const Json json = read_json(dir / "whole" / "posterior.json");
  ASSERT_GE(json["refinement"]["made"].get<int>(), 1);
  int further = 0;
  for (const auto& c : json["refinement"]["checks"]) further += c["runs"].get<int>();
  const double before = 1 - double(further) / json["runs"]["made"].get<int>();  // the share of its runs that it makes ere it refines
  goes_on_to_the_same_draws(dir, options, {before + 0.2 * (1 - before), before + 0.8 * (1 - before)});
  EXPECT_EQ(read_json(dir / "killed" / "posterior.json")["refinement"], json["refinement"]);
}

TEST(SampleVerb, UsesTheEstimateOfTheNoiseAloneOnRequestAndComparesOtherErrors) {
  const auto dir = folder("sample_compared");
  const auto out = run(dir, "sample case.toml --out a --set posterior.hyperparameter_draws=0 --set 'posterior.compare=[\"no_mesh_errors\",\"independent\"]'");
  ASSERT_EQ(out.status, 0) << out.said;
  const Json json = read_json(dir / "a" / "posterior.json");
  EXPECT_EQ(json["hyperparameters"]["draws"], 0);
  EXPECT_FALSE(json["hyperparameters"]["reason"].get<std::string>().empty());
  ASSERT_EQ(json["compared"].size(), 2u);
  for (const auto& form : json["compared"]) {
    EXPECT_FALSE(form["what"].get<std::string>().empty());
    EXPECT_EQ(form["regions"]["parameters"], Json({"density", "sound_speed"}));
    // Errors that leave something out give a narrower answer.
    EXPECT_LT(form["parameters"][0]["sd"].get<double>(), json["parameters"][0]["sd"].get<double>());
  }
}

TEST(SampleVerb, ReportsWhyAPosteriorIsNotToBeTrusted) {
  const auto dir = folder("sample_short");
  const auto out = run(dir, "sample case.toml --out a --set sampler.draws=50 --set sampler.warmup=50 --set emulator.rounds=1");
  EXPECT_EQ(out.status, 4) << out.said;
  const Json json = read_json(dir / "a" / "posterior.json");
  EXPECT_FALSE(json["converged"].get<bool>());
  EXPECT_THAT(out.said, HasSubstr(json["message"].get<std::string>()));
}
