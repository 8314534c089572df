// `calomel sample` with samplers other than DRAM, on one emulator whose runs are made once.
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "base/netcdf_file.hpp"
#include "tests/regression/slice_case.hpp"

using namespace calomel::testing;
using calomel::Json;
using calomel::NetcdfReader;
using calomel::read_json;
using ::testing::AnyOf;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

namespace {

const std::string tables = R"([parameter.density]
min = 12000
max = 14500
[parameter.sound_speed]
min = 1300
max = 1600
[campaign]
pulses = 2
[emulator]
element_sizes = [0.002]
viscosity_sd = 0
start = "nominal"
fine_runs = 12
round_fine = 2
rounds = 2
check_coarse = 0
check_fine = 1
[errors]
band = 1e5
young_sd = 0
)";

/// Samples with a kind; the run ends well or is not to be trusted, and its summary is that of the kind.
Json sampled(const fs::path& dir, const std::string& kind, const std::string& settings) {
  const auto out = run(dir, "sample case.toml --out a --fresh --set sampler.kind=" + kind + ' ' + settings);
  EXPECT_THAT(out.status, AnyOf(0, 4)) << out.said;
  Json json = read_json(dir / "a" / "posterior.json");
  EXPECT_EQ(json["sampler"]["kind"], kind);
  return json;
}

}  // namespace

TEST(SampleKinds, EachReportsItsOwnQuantities) {
  const auto dir = folder_with("sample_kinds", {{"case.toml", with(slice_case, "end = 2e-5", "end = 4e-5") + tables}});
  const auto made = run(dir, "simulate case.toml --mean --out truth --set material.mercury.density=13310 --set material.mercury.least_mesh_viscosity=0");
  ASSERT_EQ(made.status, 0) << made.said;
  put_records(dir);

  // Defaults of warm-up, draws and thin come with the kind.
  const Json nuts = sampled(dir, "nuts", "");
  EXPECT_EQ(nuts["sampler"]["draws"], 2000);
  EXPECT_EQ(nuts["e_bfmi"].size(), 4u);
  EXPECT_TRUE(nuts.contains("divergences"));
  EXPECT_TRUE(nuts["chains_converged"].get<bool>()) << nuts["message"];
  const NetcdfReader file(dir / "a" / "posterior.nc");
  for (const char* variable : {"sample_stats/energy", "sample_stats/diverging", "sample_stats/tree_depth"}) EXPECT_TRUE(file.has(variable)) << variable;

  const Json smc = sampled(dir, "smc", "--set sampler.draws=500");
  EXPECT_GT(smc["sampler"]["log_evidence_standard_error"], 0);
  EXPECT_LT(smc["sampler"]["log_evidence_standard_error"], 0.5);
  EXPECT_NEAR(smc["parameters"][0]["mean"].get<double>(), nuts["parameters"][0]["mean"].get<double>(), nuts["parameters"][0]["sd"].get<double>());

  const Json ensemble = sampled(dir, "ensemble", "--set sampler.warmup=500 --set sampler.draws=100");
  const int walkers = ensemble["sampler"]["walkers"];
  EXPECT_EQ(walkers, std::max<int>(8, 4 * int(ensemble["parameters"].size())));
  EXPECT_EQ(ensemble["sampler"]["chains"], 4 * walkers);

  const int before = ensemble["runs"]["held"];
  const Json delayed = sampled(dir, "delayed_acceptance", "--set sampler.draws=8 --set sampler.delayed_acceptance.settle=2");
  const int asked = delayed["sampler"]["evaluations"];
  EXPECT_GE(asked, 4 * 8);
  EXPECT_LE(asked, 4 * (1 + 2 + 8));
  EXPECT_GT(delayed["sampler"]["cheap_evaluations"], 4 * 500 * 50);
  EXPECT_GT(delayed["runs"]["held"].get<int>(), before + asked / 2);  // runs of the true model at the draws
}
