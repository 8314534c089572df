// Sentences about an analysis of sensitivity.
#include "apps/presentation/sensitivity_words.hpp"

#include <gmock/gmock.h>

#include "base/not_finite.hpp"

namespace calomel {
namespace {

using ::testing::ElementsAre;

TEST(SensitivityWords, WhatWasEvaluatedIsTheModelOrItsSurrogate) {
  EXPECT_EQ(evaluated_sentence(nullptr), "all by the model itself");
  KnownRuns runs{.thetas = Eigen::MatrixXd::Zero(1, 3), .means = Eigen::MatrixXd::Ones(2, 3)};
  const std::string by_surrogate =
      "Sobol' indices and elementary effects are those of the surrogate, the polynomial is fitted to the campaign's runs of the model";
  EXPECT_EQ(evaluated_sentence(&runs), by_surrogate);
  runs.means.col(1).setConstant(nan);
  EXPECT_EQ(evaluated_sentence(&runs), by_surrogate + "; 1 of its 3 runs failed, and the surrogate still predicts there");
}

TEST(SensitivityWords, SharesAreInDoubtWhereManyEvaluationsOrRunsFailed) {
  Sensitivity s{.evaluations = 320, .failed = 100, .rows = 16, .design_rows = 64};
  EXPECT_EQ(sensitivity_doubt(s, true), "");
  EXPECT_EQ(sensitivity_doubt(s, false), "the campaign or the surrogate is not to be trusted: campaign.json and train.json give the reason");
  s.many_failed = true;
  EXPECT_EQ(sensitivity_doubt(s, false),
            "100 of 320 evaluations of the model failed, more than a fifth: the shares are of 16 of 64 rows of the design, those where the model has answers; "
            "narrow the bounds of the parameters to where it has");
}

TEST(SensitivityWords, ATotalHasASourceAndANote) {
  QuantitySensitivity q{.name = "dissipated_energy", .unit = "J", .mean = 0.25};
  EXPECT_EQ(total_source(q), "");
  EXPECT_EQ(share_note(q, 3), "");
  q.polynomial_order = 3;
  q.runs = 198;
  EXPECT_EQ(total_source(q), "a polynomial of order 3 fitted to 198 runs at pulse energy 1");
  q.finding = ShareFinding::poor_polynomial;
  q.left_out_r2 = 0.456;
  EXPECT_EQ(share_note(q, 3), "the polynomial does not follow the runs (left-out R2 0.46), so that its shares say little");
  q.finding = ShareFinding::constant;
  EXPECT_EQ(share_note(q, 3), "it does not vary within these bounds, so that no parameter has a share");
  q.finding = ShareFinding::no_run;
  EXPECT_EQ(share_note(q, 3), "no run has it");
  q.finding = ShareFinding::same_in_all_runs;
  EXPECT_EQ(share_note(q, 3), "it is 0.25 J in all 198 runs: it does not vary within these bounds, so that no parameter has a share");
  q.finding = ShareFinding::few_runs;
  q.runs = 11;
  q.needed_runs = 12;
  EXPECT_EQ(share_note(q, 2), "11 runs with it are too few for a polynomial of 2 parameters, which takes 12");
}

TEST(SensitivityWords, EveryParameterAndEveryTotalHasALine) {
  const std::vector<Parameter> parameters{{.name = "density"}};
  QuantitySensitivity energy{.name = "dissipated_energy", .condition = "low", .unit = "J", .mean = 12.34, .sd = 1.56};
  energy.sobol.first_order = {{.value = 0.75}};
  energy.sobol.total_order = {{.value = 0.875}};
  energy.polynomial_order = 2;
  energy.runs = 40;
  energy.left_out_r2 = 0.9876;
  QuantitySensitivity none = energy;
  none.polynomial_order.reset();
  none.finding = ShareFinding::no_run;
  QuantitySensitivity whole{.name = "record"};
  whole.sobol.first_order = {{.value = 0.5, .low = 0.25, .high = 0.625}};
  whole.sobol.total_order = {{.value = 0.75, .low = 0.5, .high = 1}};
  const Sensitivity s{.quantities = {energy, none, whole}, .evaluations = 320, .failed = 3};
  const SensitivityWords words = sensitivity_words(s, 1, nullptr, false);
  EXPECT_THAT(words.sources, ElementsAre("a polynomial of order 2 fitted to 40 runs at pulse energy 1", "", ""));
  EXPECT_THAT(words.notes, ElementsAre("", "no run has it", ""));
  EXPECT_THAT(sensitivity_lines(s, words, parameters),
              ElementsAre("sensitivity: density: 0.5 of the variance of all records alone (0.25 to 0.625), 0.75 with the others (0.5 to 1)",
                          "sensitivity: dissipated_energy of low: 12.3 J with sd 1.6; density 0.75 alone, 0.875 with the others; by a polynomial of order 2 "
                          "fitted to 40 runs at pulse energy 1, left-out R2 0.988",
                          "sensitivity: dissipated_energy of low: no run has it", "sensitivity: not to be trusted: " + words.doubt,
                          "sensitivity: 320 evaluations, 3 failed; every gauge and time in sensitivity.nc, a table in sensitivity.csv"));
}

}  // namespace
}  // namespace calomel
