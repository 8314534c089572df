#include "apps/report/sections/polynomials.hpp"

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

TEST(ReportPolynomials, ErrorsChoicesOfLambdaAndModesAreShown) {
  const auto dir = scratch("polynomials");
  write_calibration(dir, input(), "spe");
  EXPECT_TRUE(polynomial_table(read_study(dir)).empty() && lambda_table(read_study(dir)).empty() && polynomial_error_table(read_study(dir)).empty());
  Json spe = read_json(dir / "spe.json");
  spe["surrogates"] = {{{"name", "total_degree 10"},
                        {"terms", 286},
                        {"nonzero", 40},
                        {"lambda", 50.0},
                        {"lambda_max", 2000.0},
                        {"train", {{"rrmse", 0.02}, {"r2", 0.99}}},
                        {"validation", {{"rrmse", 0.06}, {"r2", 0.95}}},
                        {"optima", 2},
                        {"best", 60.0}},
                       {{"name", "total_degree 10"},
                        {"terms", 286},
                        {"nonzero", 0},
                        {"lambda", 2000.0},
                        {"lambda_max", 2000.0},
                        {"train", {{"rrmse", 0.5}, {"r2", 0.0}}},
                        {"validation", {{"rrmse", 0.5}, {"r2", 0.0}}},
                        {"failure", "every coefficient vanishes"}}};
  spe["lambda_choices"] = {{{"name", "total_degree 10"},
                            {"terms", 286},
                            {"lambda_max", 2000.0},
                            {"validation", {{"lambda", 40.0}, {"fraction", 0.02}, {"mean_squared_error", 7.0}}},
                            {"cross_validation", {{"lambda", 60.0}, {"fraction", 0.03}, {"mean_squared_error", 8.0}}}}};
  spe["modes"] = {{{"theta", spe["theta"]}, {"objective_surrogate", 61.0}, {"density", 0.4}, {"optima", 30}}};
  spe["validation_rrmse"] = {{"min", 0.04}, {"mean", 0.06}, {"max", 0.1}};
  write_json(dir / "spe.json", spe);
  const Study study = read_study(dir);
  const Table polynomials = polynomial_table(study), lambdas = lambda_table(study);
  ASSERT_EQ(polynomials.rows.size(), 2u);
  EXPECT_DOUBLE_EQ(std::get<double>(polynomials.rows[0][4].value), 0.025);
  EXPECT_EQ(std::get<std::string>(polynomials.rows[1][10].value), "every coefficient vanishes");
  for (const auto& row : lambdas.rows) ASSERT_EQ(row.size(), lambdas.columns.size());
  EXPECT_EQ(std::get<double>(lambdas.rows[0][7].value), 0.03);
  EXPECT_EQ(std::get<double>(polynomial_error_table(study).rows[0][2].value), 6);
  write_report(dir, input());
  EXPECT_THAT(read_text(dir / "report.html"),
              testing::AllOf(HasSubstr("All 2 polynomial surrogates"), HasSubstr("cross-validation"), HasSubstr("densest first")));
}
