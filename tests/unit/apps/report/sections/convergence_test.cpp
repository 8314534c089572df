#include "apps/report/sections/convergence.hpp"

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
using testing::Not;

namespace {

Json comparison_of_optimizers(double last) {
  const auto method = [&](const char* name, double end) {
    return Json{{"name", name}, {"evaluations", {26, 52, 78}}, {"mean", {140.0, 120.0, end}}, {"sd", {9.0, 4.0, 1.0}}, {"best", end - 1}, {"worst", end + 2}};
  };
  return {{"trials", 50},
          {"targets",
           {{{"name", "total_degree 15"}, {"methods", {method("dgs", last), method("de", last + 1)}}},
            {{"name", "total_degree 16"}, {"methods", {method("dgs", last + 5)}}}}}};
}

}  // namespace

TEST(ReportComparison, OptimisersAndFormulationsAreComparedWithTheBestOfAll) {
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
  EXPECT_EQ(std::get<double>(formulations.rows[1][7].value), 53);  // paper_enc at the optimum of rrmse
  write_report(dir, input());
  EXPECT_THAT(read_text(dir / "report.html"), testing::AllOf(HasSubstr("The optimisers agree."), HasSubstr("Distance [bounds]")));
}

TEST(ReportComparison, TheDecayOfOptimisersIsShownWhenItsArtefactExists) {
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
