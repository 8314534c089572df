#include <gmock/gmock.h>

#include <cmath>

#include "apps/report/comparison_tables.hpp"
#include "apps/report/emulator_tables.hpp"
#include "apps/report/tables.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "tests/unit/apps/report_study.hpp"

namespace calomel {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing_report::input;
using testing_report::write_calibration;

/// enc.json and map.json of one case; MAP with standard deviations 1000, 400 and 50, without correlation.
std::filesystem::path two_methods(const std::string& name) {
  const auto dir = scratch(name);
  for (const char* method : {"enc", "map"}) write_calibration(dir, input(), method);
  Json map = read_json(dir / "map.json");
  map["parameters"] = {"tensile_cutoff", "density", "sound_speed"};
  map["covariance"] = {{1e6, 0, 0}, {0, 1.6e5, 0}, {0, 0, 2500}};
  write_json(dir / "map.json", map);
  return dir;
}

Json comparison_of_optimizers(double last) {
  const auto method = [&](const char* name, double end) {
    return Json{{"name", name}, {"evaluations", {26, 52, 78}}, {"mean", {140.0, 120.0, end}}, {"sd", {9.0, 4.0, 1.0}}, {"best", end - 1}, {"worst", end + 2}};
  };
  return {{"trials", 50},
          {"targets",
           {{{"name", "total_degree 15"}, {"methods", {method("dgs", last), method("de", last + 1)}}},
            {{"name", "total_degree 16"}, {"methods", {method("dgs", last + 5)}}}}}};
}

TEST(ReportComparison, TheParameterTableHasTheNominalValuesFirstAndMapsStandardDeviations) {
  const auto dir = two_methods("sds");
  const Table t = parameter_table(read_study(dir), input());
  std::vector<std::string> keys;
  for (const auto& c : t.columns) keys.push_back(c.key);
  EXPECT_THAT(keys, testing::ElementsAre("parameter", "unit", "nominal", "enc", "map", "map_sd", "enc_change_percent", "map_change_percent", "min", "max"));
  EXPECT_EQ(std::get<double>(t.rows[1][5].value), 400);
  for (const auto& row : t.rows) EXPECT_EQ(row.size(), t.columns.size());
}

TEST(ReportComparison, DifferencesBeyondTwoStandardDeviationsAreBold) {
  const auto dir = two_methods("apart");
  const Table t = agreement_table(read_study(dir));  // cutoff 85642 and 53300, density 10345 and 7720, sound speed 2020 and 2449
  ASSERT_EQ(t.columns.size(), 3u);
  EXPECT_NEAR(std::get<double>(t.rows[1][2].value), (7720 - 10345) / 400.0, 1e-12);
  EXPECT_TRUE(t.rows[1][2].strong);
  EXPECT_THAT(t.note, HasSubstr("ENC lies outside the posterior"));
  Json map = read_json(dir / "map.json");
  map["theta"] = read_json(dir / "enc.json")["theta"];
  map["theta"]["density"] = 10345 + 300;
  write_json(dir / "map.json", map);
  const Table near = agreement_table(read_study(dir));
  EXPECT_NEAR(std::get<double>(near.rows[1][2].value), 0.75, 1e-12);
  EXPECT_FALSE(near.rows[1][2].strong);
  EXPECT_THAT(near.note, testing::AllOf(HasSubstr("ENC lies within the posterior"), Not(HasSubstr("outside"))));
}

// Without correlation d^2 is the sum of the squares in each parameter's deviation.
TEST(ReportComparison, AnswersHaveTheirPlaceInThePosterior) {
  const auto dir = two_methods("place");
  const Table t = place_table(read_study(dir));
  ASSERT_EQ(t.rows.size(), 1u);
  const double d = std::sqrt(std::pow((85642.0 - 53300) / 1000, 2) + std::pow((10345.0 - 7720) / 400, 2) + std::pow((2020.0 - 2449) / 50, 2));
  EXPECT_NEAR(std::get<double>(t.rows[0][1].value), d, 1e-9);
  EXPECT_TRUE(t.rows[0][1].strong);
  Json map = read_json(dir / "map.json");
  map["theta"] = read_json(dir / "enc.json")["theta"];
  map["theta"]["density"] = 10345 + 300;
  write_json(dir / "map.json", map);
  const Table near = place_table(read_study(dir));
  EXPECT_NEAR(std::get<double>(near.rows[0][1].value), 0.75, 1e-12);
  EXPECT_FALSE(near.rows[0][1].strong);
  write_report(dir, input());
  EXPECT_THAT(read_text(dir / "report.html"), HasSubstr("Share of it that lies nearer"));
  map.erase("covariance");
  write_json(dir / "map.json", map);
  EXPECT_TRUE(place_table(read_study(dir)).empty());
}

TEST(ReportComparison, ANestedModelHasOneRow) {
  const auto dir = two_methods("hypotheses");
  EXPECT_TRUE(hypothesis_table(read_study(dir)).empty());
  Json map = read_json(dir / "map.json");
  map["nested_model"] = {{"with", "base.out"},
                         {"added", {"width", "offset"}},
                         {"log_bayes_factor", 30.0},
                         {"low", 28.6},
                         {"high", 31.4},
                         {"chi2", 90.0},
                         {"nested_chi2", 150.0},
                         {"emulator_variance", 0.125},
                         {"nested_emulator_variance", 0.25},
                         {"verdict", "favoured"},
                         {"sentence", "the records favour width and offset over base.out"}};
  write_json(dir / "map.json", map);
  const Table t = hypothesis_table(read_study(dir));
  ASSERT_EQ(t.rows.size(), 1u);
  ASSERT_EQ(t.rows[0].size(), t.columns.size());
  EXPECT_EQ(std::get<std::string>(t.rows[0][1].value), "width, offset");
  const double numbers[] = {30, 28.6, 31.4, 90, 150, 0.125, 0.25};
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(std::get<double>(t.rows[0][2 + i].value), numbers[i]) << t.columns[2 + i].key;
  EXPECT_EQ(t.note, "the records favour width and offset over base.out");
}

TEST(ReportEmulator, NuisancesRunsAndSharesAreTold) {
  const auto dir = two_methods("emulator");
  const Study without = read_study(dir);
  EXPECT_TRUE(nuisance_table(without).empty() && emulator_table(without).empty() && share_table(without).empty());
  EXPECT_EQ(emulator_section(without), "");
  Json map = read_json(dir / "map.json");
  map["identified"] = "the data pin the impedance", map["adequate"] = true, map["adequacy"] = "the records do not contradict the fit";
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

// What calomel sample wrote tells the same where there is no MAP.
TEST(ReportEmulator, ThePosteriorsEmulatorIsShownWithoutMap) {
  const auto dir = scratch("emulator_of_sample");
  write_calibration(dir, input(), "enc");
  write_json(dir / "posterior.json",
             {{"mode", {{"settled", false}, {"message", "not settled after 9 runs"}, {"levels", {{{"runs", 9}, {"left_out", 0.02}, {"noise", 0.01}}}}}}});
  const Study study = read_study(dir);
  EXPECT_EQ(emulator_table(study).rows.size(), 1u);
  EXPECT_TRUE(nuisance_table(study).empty());
  EXPECT_THAT(emulator_section(study), HasSubstr("<strong>The emulator: not settled after 9 runs.</strong>"));
}

TEST(ReportTables, NominalScoresBeyondTheEmulatorAreMarked) {
  const auto dir = scratch("nominal_outside");
  write_calibration(dir, input(), "enc");
  EXPECT_THAT(headline_table(read_study(dir), input()).note, Not(HasSubstr("outside the emulator")));
  Json enc = read_json(dir / "enc.json");
  enc["mesh"] = {{"nominal_inside_emulator", false}, {"working_mesh", {{"accuracy", 50.0}, {"mae", 20.0}}}};
  write_json(dir / "enc.json", enc);
  const Study study = read_study(dir);
  EXPECT_THAT(headline_table(study, input()).note, HasSubstr("The nominal point lies outside the emulator\u2019s box (ENC)"));
  EXPECT_THAT(score_table(study, input(), "accuracy").note, HasSubstr("outside the emulator"));
  EXPECT_THAT(mesh_table(study, input()).note, HasSubstr("outside the emulator"));
}

TEST(ReportTables, CaptionsTellWhichMeshEverySimulationIsOn) {
  const auto dir = two_methods("meshes");
  EXPECT_THAT(headline_table(read_study(dir), input()).caption, Not(HasSubstr("mesh")));
  Json enc = read_json(dir / "enc.json"), map = read_json(dir / "map.json");
  map["scores_on"] = "the finest mesh of the emulator";
  write_json(dir / "map.json", map);
  EXPECT_THAT(headline_table(read_study(dir), input()).caption,
              HasSubstr("Simulations of MAP are runs on the finest mesh of the emulator; the others are on the case\u2019s mesh."));
  enc["mesh"] = {{"working_mesh", {{"accuracy", 50.0}, {"mae", 20.0}}}};
  write_json(dir / "enc.json", enc);
  EXPECT_THAT(headline_table(read_study(dir), input()).caption,
              HasSubstr("as the runs on finer meshes tell; those of MAP are runs on the finest mesh of the emulator."));
}

TEST(ReportComparison, OptimisersAndFormulationsStandBesideTheBestOfAll) {
  const auto dir = two_methods("optimizers");
  EXPECT_TRUE(optimizer_agreement_table(read_study(dir)).empty());
  EXPECT_TRUE(formulation_table(read_study(dir), input()).empty());
  Json enc = read_json(dir / "enc.json");
  const auto of = [](const char* name, double best) {
    return Json{{"name", name},           {"rounds", 4},      {"mean", best - 1},       {"sd", 0.5}, {"best", best},
                {"shortfall", 66 - best}, {"distance", 0.01}, {"share_of_rounds", 0.75}};
  };
  const auto formulation = [&](const char* name, double accuracy) {
    return Json{{"name", name},         {"theta", enc["theta"]}, {"distance", 0.2},
                {"accuracy", accuracy}, {"mae", 17.0},           {"objectives_model", {{"paper_enc", accuracy - 17}, {"rrmse", 0.25}}}};
  };
  enc["agreement"] = {{"sentence", "The optimisers agree."},
                      {"optimizers", {of("de", 66), of("gradient", 65)}},
                      {"objectives", {formulation("paper_enc", 80), formulation("rrmse", 70)}}};
  write_json(dir / "enc.json", enc);
  const Study study = read_study(dir);
  const Table optimizers = optimizer_agreement_table(study), formulations = formulation_table(study, input());
  ASSERT_EQ(optimizers.rows.size(), 2u);
  EXPECT_EQ(std::get<double>(optimizers.rows[1][5].value), 1);
  EXPECT_EQ(optimizers.note, "The optimisers agree.");
  ASSERT_EQ(formulations.rows.size(), 2u);
  for (const auto& row : formulations.rows) ASSERT_EQ(row.size(), formulations.columns.size());
  EXPECT_EQ(formulations.columns.back().key, "value_rrmse");
  EXPECT_EQ(std::get<double>(formulations.rows[1][7].value), 53);  // paper_enc at the answer of rrmse
  write_report(dir, input());
  EXPECT_THAT(read_text(dir / "report.html"), testing::AllOf(HasSubstr("The optimisers agree."), HasSubstr("Distance [bounds]")));
}

TEST(ReportComparison, OneCalibrationIsNotCompared) {
  const auto dir = scratch("one");
  write_calibration(dir, input(), "enc");
  EXPECT_TRUE(agreement_table(read_study(dir)).empty());
  EXPECT_TRUE(effort_table(read_study(dir)).empty());
}

TEST(ReportComparison, TheDecayOfOptimisersIsPickedUpWhereItStands) {
  const auto dir = two_methods("decay");
  EXPECT_TRUE(decay_json(read_study(dir)).is_null());
  EXPECT_TRUE(trial_table(read_study(dir)).empty());
  write_json(dir / "optimizer_comparison.json", comparison_of_optimizers(100));
  const Study study = read_study(dir);
  const Json figures = decay_json(study);
  ASSERT_EQ(figures.size(), 2u);
  EXPECT_EQ(figures[0]["lines"].size(), 2u);
  EXPECT_EQ(figures[0]["lines"][0]["high"][1], 132);
  EXPECT_EQ(figures[0]["lines"][0]["low"][2], 97);
  EXPECT_EQ(figures[0]["span"][0], 99);
  EXPECT_EQ(figures[0]["span"][1], 120);
  EXPECT_EQ(decay_table(study).rows.size(), 9u);
  EXPECT_EQ(std::get<double>(trial_table(study).rows[1][3].value), 101);
  write_report(dir, input());
  const std::string page = read_text(dir / "report.html");
  EXPECT_THAT(page, testing::AllOf(HasSubstr("id=\"decay-plot-0\""), HasSubstr("id=\"decay-plot-1\""), Not(HasSubstr("id=\"decay-plot-2\""))));
}

TEST(ReportComparison, AMalformedComparisonDrawsNothing) {
  const auto dir = two_methods("malformed");
  write_json(dir / "optimizer_comparison.json", {{"targets", {{{"name", "a"}, {"methods", {{{"name", "dgs"}, {"evaluations", {1, 2}}, {"mean", {3}}}}}}}}});
  EXPECT_TRUE(decay_json(read_study(dir)).is_null());
  EXPECT_NO_THROW(write_report(dir, input()));
}

}  // namespace
}  // namespace calomel
