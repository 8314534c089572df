#include "apps/report/sections/published.hpp"

#include <gmock/gmock.h>

#include <string>

#include "apps/report/data/study.hpp"
#include "tests/unit/apps/report/study.hpp"

using namespace calomel;
using namespace calomel::testing_report;
using testing::HasSubstr;

TEST(ReportPosterior, PublishedValuesAreShownOnlyForCasesThatInferTheSameOfMercury) {
  const auto dir = scratch("posterior_published");
  const auto in = input();
  write_sample(dir, ridge_draws());
  const std::string text = published_paragraph(read_study(dir), in).str();
  EXPECT_THAT(text, HasSubstr("Model Calibration of the Liquid Mercury Spallation Target using Evolutionary Neural Networks and Sparse Polynomial Expansions"));
  EXPECT_THAT(text, HasSubstr("ENC 10\u202f345\u00a0kg/m\u00b3, 2020\u00a0m/s, 85\u202f642\u00a0Pa"));
  EXPECT_THAT(text, HasSubstr("SPE 7720\u00a0kg/m\u00b3, 2449\u00a0m/s, 53\u202f300\u00a0Pa"));
  EXPECT_THAT(text, HasSubstr("\u03c1c = 20.9\u00a0MPa\u00b7s/m"));
  EXPECT_THAT(text, HasSubstr("Here \u03c1c is 19.4\u00a0MPa\u00b7s/m"));
  auto fewer = in, water = in, more = in;
  fewer.parameters.pop_back();
  water.options["material"]["mercury"]["density"] = 998.0;
  more.parameters.push_back({.name = "viscosity", .key = "solver.viscosity", .min = 0, .max = 1});
  for (const auto& other : {fewer, water, more}) {
    EXPECT_TRUE(published_answers(other).empty());
    EXPECT_EQ(published_paragraph(read_study(dir), other).str(), "");
  }
}
