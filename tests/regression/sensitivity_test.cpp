// `calomel sensitivity` of dissipated energy and time at cutoff: what is made for them, and what remains as it is.
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/regression/slice_case.hpp"

using namespace calomel::testing;
using calomel::NetcdfReader;
using calomel::number_text;
using calomel::read_json;
using calomel::read_text;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

namespace {

const std::string more =
    "[parameter.tensile_cutoff]\nmin = 5e4\nmax = 3e5\n[parameter.density]\nmin = 12500\nmax = 14000\n[campaign]\nruns = 12\nfloor = false\n"
    "[surrogate]\ncompare = []\n[sensitivity]\nsamples = 64\ntrajectories = 4\n";

const calomel::Json& quantity(const calomel::Json& json, const std::string& name) {
  for (const auto& q : json["quantities"])
    if (q["name"] == name) return q;
  static const calomel::Json none;
  return none;
}

}  // namespace

TEST(SensitivityVerb, TotalsAreThoseOfSimulationsAndNothingElseIsRepeated) {
  const auto dir = folder_with("sensitivity_totals", {{"case.toml", slice_case + more}});
  const auto out = dir / "case.out";
  ASSERT_EQ(run(dir, "sensitivity case.toml").status, 0);
  EXPECT_TRUE(quantity(read_json(out / "sensitivity.json"), "dissipated_energy").is_null());
  EXPECT_FALSE(read_json(out / "sensitivity.json")["provenance"]["options"]["sensitivity"].contains("run_totals"));
  const std::string campaign = read_text(out / "campaign.nc"), surrogate = read_text(out / "surrogate.nc"), journal = read_text(out / "runs.journal");

  const std::string totals = "sensitivity case.toml --set sensitivity.run_totals=true";
  const auto refused = run(dir, totals);
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.said, HasSubstr("sensitivity.run_totals"));
  const auto made = run(dir, totals + " --fresh");
  ASSERT_EQ(made.status, 0) << made.said;
  EXPECT_THAT(made.said, HasSubstr("sensitivity: dissipated_energy: "));
  EXPECT_EQ(read_text(out / "campaign.nc"), campaign);
  EXPECT_EQ(read_text(out / "surrogate.nc"), surrogate);
  const std::string longer = read_text(out / "runs.journal");
  EXPECT_EQ(longer.substr(0, journal.size()), journal);
  EXPECT_GT(longer.size(), journal.size());

  const auto json = read_json(out / "sensitivity.json");
  for (const char* name : {"dissipated_energy", "time_at_cutoff"}) {
    EXPECT_GT(quantity(json, name)["sd"].get<double>(), 0) << name;
    EXPECT_TRUE(quantity(json, name)["left_out_r2"].is_number()) << name;
  }
  EXPECT_EQ(json["quantities"].back()["name"], "record");
  EXPECT_THAT(read_text(out / "sensitivity.csv"), HasSubstr("\ntime_at_cutoff,,,s,"));

  // At the points of the campaign: the energy balance of a simulation there, to the last digit.
  const NetcdfReader file(out / "sensitivity.nc"), runs(out / "campaign.nc");
  const auto theta = file.doubles("run_theta"), energy = file.doubles("run_dissipated_energy"), time = file.doubles("run_time_at_cutoff");
  EXPECT_EQ(theta, runs.doubles("theta"));
  ASSERT_EQ(energy.size(), 12u);
  for (const std::size_t i : {0u, 7u}) {
    const std::string at =
        " --set material.mercury.tensile_cutoff=" + number_text(theta[2 * i]) + " --set material.mercury.density=" + number_text(theta[2 * i + 1]);
    ASSERT_EQ(run(dir, "simulate case.toml --out alone" + at).status, 0);
    const auto alone = read_json(dir / "alone" / "simulate.json");
    EXPECT_EQ(energy[i], alone["dissipated_J"].get<double>());
    EXPECT_EQ(time[i], alone["time_at_cutoff_s"].get<double>());
    EXPECT_LT(alone["energy_balance_error"].get<double>(), 0.01);
  }
  ASSERT_EQ(run(dir, totals + " --fresh").status, 0);
  EXPECT_EQ(read_text(out / "runs.journal"), longer) << "runs that are held are taken";
}

TEST(SensitivityVerb, WithoutACutoffTheTimeAtItIsReportedAsConstant) {
  const auto dir =
      folder_with("sensitivity_linear", {{"case.toml", with(slice_case, "law = \"riemer\"", "law = \"linear\"") +
                                                           with(more, "[parameter.tensile_cutoff]\nmin = 5e4\nmax = 3e5\n", "") + "run_totals = true\n"}});
  const auto made = run(dir, "sensitivity case.toml");
  ASSERT_EQ(made.status, 0) << made.said;
  EXPECT_THAT(made.said, HasSubstr("sensitivity: time_at_cutoff: it is 0 s in all 12 runs: it does not vary"));
  EXPECT_THAT(made.said, Not(HasSubstr("nan")));
  EXPECT_EQ(read_text(dir / "case.out" / "sensitivity.csv").find("nan"), std::string::npos);
  const auto json = read_json(dir / "case.out" / "sensitivity.json");
  EXPECT_TRUE(quantity(json, "time_at_cutoff")["total_order"][0]["value"].is_null());
  EXPECT_NEAR(quantity(json, "dissipated_energy")["total_order"][0]["value"].get<double>(), 1, 1e-9) << "one parameter has it all";
}

TEST(SensitivityVerb, TotalsOfAnotherModelAreRefused) {
  const auto dir =
      folder_with("sensitivity_outside",
                  {{"case.toml",
                    "[model]\nkind = \"umbridge\"\nurl = \"http://127.0.0.1:1\"\nname = \"m\"\n[parameter.a]\nmin = 0\nmax = 1\nprior = \"uniform\"\n"
                    "[output]\nsensors = [\"A\"]\ntime = { start = 0.0, step = 1e-3, count = 4 }\n[sensitivity]\nrun_totals = true\n"}});
  const auto refused = run(dir, "check case.toml");
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.said, HasSubstr("only runs on a mesh keep an energy balance"));
}
