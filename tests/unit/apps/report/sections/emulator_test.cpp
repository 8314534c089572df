#include "apps/report/sections/emulator.hpp"

#include <gmock/gmock.h>

#include <string>
#include <variant>

#include "apps/report/data/study.hpp"
#include "apps/report/report.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::HasSubstr;

TEST(ReportEmulator, NuisancesRunsAndSharesAreShown) {
  const auto dir = two_methods("emulator");
  const Study without = read_study(dir);
  EXPECT_TRUE(nuisance_table(without).empty() && emulator_table(without).empty() && share_table(without).empty());
  EXPECT_EQ(emulator_section(without).str(), "");
  Json map = read_json(dir / "map.json");
  map["identified"] = "the data pin the impedance";
  map["adequate"] = true;
  map["adequacy"] = "the records do not contradict the fit";
  map["nuisances"] = {{{"name", "viscosity"}, {"value", 1800.0}, {"sd", 300.0}, {"prior_value", 2000.0}, {"prior_sd", 1200.0}, {"pull", -0.18}},
                      {{"name", "young"}, {"value", 2.1e11}, {"sd", 1e9}, {"prior_value", 2e11}, {"prior_sd", 3e9}, {"pull", 3.2}}};
  map["emulator"] = {{"settled", true},
                     {"message", "settled after 48 coarse and 14 fine runs"},
                     {"levels", {{{"runs", 14}, {"left_out", 0.013}, {"noise", 0.009}}, {{"runs", 48}, {"left_out", 0.011}, {"noise", 0.01}}}},
                     {"covariance_shares", {{"baseline", 0.25}, {"noise", 0.75}}}};
  map["true_model_check"] = {{"holds", false}, {"sentence", "the true model lies farther off than the emulator says"}};
  write_json(dir / "map.json", map);
  const Study study = read_study(dir);
  const Table nuisances = nuisance_table(study), emulator = emulator_table(study), shares = share_table(study);
  ASSERT_EQ(nuisances.rows.size(), 2u);
  EXPECT_EQ(std::get<double>(nuisances.rows[0][5].value), -0.18);
  EXPECT_FALSE(nuisances.rows[0][5].strong);
  EXPECT_TRUE(nuisances.rows[1][5].strong);
  ASSERT_EQ(emulator.rows.size(), 2u);
  EXPECT_EQ(std::get<std::string>(emulator.rows[0][0].value), "finest");
  EXPECT_EQ(std::get<double>(emulator.rows[0][2].value), 0.013);
  EXPECT_EQ(std::get<double>(emulator.rows[1][1].value), 48);
  ASSERT_EQ(shares.rows.size(), 2u);
  EXPECT_EQ(std::get<std::string>(shares.rows[0][0].value), "noise");
  write_report(dir, input());
  EXPECT_THAT(read_text(dir / "report.html"),
              testing::AllOf(HasSubstr("<p>The data pin the impedance.</p>"), HasSubstr("<p>The emulator: settled after 48 coarse and 14 fine runs.</p>"),
                             HasSubstr("<strong>The true model lies farther off than the emulator says.</strong>"), HasSubstr("Numerical noise of a run")));
}

// Without MAP the section comes from posterior.json.
TEST(ReportEmulator, ThePosteriorsEmulatorIsShownWithoutMap) {
  const auto dir = scratch("emulator_of_sample");
  write_calibration(dir, input(), "enc");
  write_json(dir / "posterior.json",
             {{"mode", {{"settled", false}, {"message", "not settled after 9 runs"}, {"levels", {{{"runs", 9}, {"left_out", 0.02}, {"noise", 0.01}}}}}}});
  const Study study = read_study(dir);
  EXPECT_EQ(emulator_table(study).rows.size(), 1u);
  EXPECT_TRUE(nuisance_table(study).empty());
  EXPECT_THAT(emulator_section(study).str(), HasSubstr("<strong>The emulator: not settled after 9 runs.</strong>"));
}
