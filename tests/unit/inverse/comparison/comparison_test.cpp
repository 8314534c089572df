#include "inverse/comparison/comparison.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/provenance.hpp"

namespace calomel {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

Json summary(double density, double sound_speed, double accuracy_a, double accuracy_b) {
  return {{"theta", {{"density", density}, {"sound_speed", sound_speed}}},
          {"nominal", {{"density", 13500}, {"sound_speed", 1450}}},
          {"impedance", {{"value", density * sound_speed}, {"nominal", 13500.0 * 1450}, {"unit", "kg m-2 s-1"}}},
          {"accuracy", 0.5 * (accuracy_a + accuracy_b)},
          {"nominal_accuracy", 60},
          {"mae", 10},
          {"nominal_mae", 20},
          {"mae_unit", "microstrain"},
          {"sensors", {{{"name", "A"}, {"accuracy", accuracy_a}, {"mae", 9}, {"nominal_accuracy", 55}, {"nominal_mae", 19}},
                       {{"name", "B"}, {"accuracy", accuracy_b}, {"mae", 11}, {"nominal_accuracy", 65}, {"nominal_mae", 21}}}},
          {"evaluations", 404000},
          {"model_runs", 9},
          {"search_s", 4.0},
          {"model_s", 6.0}};
}

Json map_summary(double density, double sound_speed) {
  Json j = summary(density, sound_speed, 90, 80);
  j["parameters"] = {"density", "sound_speed"};
  // sd 100 and 10, correlation -0.9
  j["covariance"] = {{1e4, -900}, {-900, 100}};
  return j;
}

TEST(Comparison, HoldsTheThreeTablesInTheOrderOfTheCase) {
  const std::vector<MethodSummary> all{{"enc", summary(13300, 1400, 85, 75)}, {"spe", summary(13350, 1410, 86, 70)}, {"map", map_summary(13400, 1390)}};
  const auto c = compare_calibrations(all);
  EXPECT_THAT(c.methods, ElementsAre("enc", "spe", "map"));
  ASSERT_EQ(c.parameters.size(), 3u);
  EXPECT_EQ(c.parameters[0].name, "density");
  EXPECT_THAT(c.parameters[0].values, ElementsAre(13300, 13350, 13400));
  EXPECT_EQ(c.parameters[0].nominal, 13500);
  EXPECT_EQ(c.parameters[0].map_sd, 100);
  EXPECT_EQ(c.parameters[2].name, "impedance");
  EXPECT_EQ(c.parameters[2].values[2], 13400.0 * 1390);
  // d(rho c) = c d rho + rho d c; the correlation makes it far narrower than its factors' own
  EXPECT_NEAR(*c.parameters[2].map_sd, std::sqrt(std::pow(1390 * 100.0, 2) + std::pow(13400 * 10.0, 2) - 2 * 1390 * 13400 * 900.0), 1);
  ASSERT_EQ(c.accuracy.size(), 3u);
  EXPECT_EQ(c.accuracy[1].name, "B");
  EXPECT_THAT(c.accuracy[1].values, ElementsAre(75, 70, 80));
  EXPECT_EQ(c.accuracy[1].nominal, 65);
  EXPECT_EQ(c.accuracy[2].name, "mean");
  EXPECT_THAT(c.accuracy[2].values, ElementsAre(80, 78, 85));
  EXPECT_THAT(c.mae[0].values, ElementsAre(9, 9, 9));
  EXPECT_EQ(c.effort[0].evaluations_per_second(), 101000);
}

TEST(Comparison, EveryMethodsOwnDeviationsStandBesideItsValues) {
  Json enc = summary(13300, 1400, 85, 75);
  enc["parameters"] = {"density", "sound_speed"}, enc["covariance"] = {{9e4, 0}, {0, 400}};
  const std::vector<MethodSummary> all{{"enc", enc}, {"spe", summary(13350, 1410, 86, 70)}, {"map", map_summary(13400, 1390)}};
  const auto c = compare_calibrations(all);
  EXPECT_EQ(c.parameters[0].sds[0], 300);
  EXPECT_FALSE(c.parameters[0].sds[1].has_value());
  EXPECT_EQ(c.parameters[0].sds[2], c.parameters[0].map_sd);
  EXPECT_NEAR(*c.parameters[2].sds[0], std::hypot(1400 * 300.0, 13300 * 20.0), 1);
  const Json j = comparison_json(c, {.stage = "comparison"});
  EXPECT_EQ(j["parameters"][0]["enc_sd"], 300);
  EXPECT_TRUE(j["parameters"][0]["spe_sd"].is_null());
  EXPECT_THAT(comparison_text(c), testing::AllOf(HasSubstr("sd by ENC"), HasSubstr("sd by MAP"), Not(HasSubstr("sd by SPE"))));
}

// A method that corrects its scores for the mesh is compared with one that does not on the mesh that both tell of.
TEST(Comparison, ScoresAreOfOneMesh) {
  const Json plain = summary(13300, 1400, 60, 50);
  Json corrected = summary(13310, 1400, 95, 93);
  corrected["scores_on"] = "the finest mesh of the emulator";
  corrected["mesh"]["working_mesh"] = {{"accuracy", 72}, {"nominal_accuracy", 58}, {"sensors", {{{"name", "A"}, {"accuracy", 71}, {"nominal_accuracy", 54}}, {{"name", "B"}, {"accuracy", 73}}}}};
  const std::vector<MethodSummary> mixed{{"enc", corrected}, {"map", plain}}, alike{{"enc", corrected}, {"spe", corrected}}, none{{"enc", plain}, {"spe", plain}};
  const auto c = compare_calibrations(mixed);
  EXPECT_THAT(c.accuracy[0].values, ElementsAre(71, 60));
  EXPECT_EQ(c.accuracy[0].nominal, 54);
  EXPECT_THAT(c.accuracy[2].values, ElementsAre(72, 55));
  EXPECT_THAT(comparison_text(c), HasSubstr("(accuracy and mae on the case's own mesh)"));
  EXPECT_THAT(compare_calibrations(alike).accuracy[0].values, ElementsAre(95, 95));
  EXPECT_EQ(compare_calibrations(alike).scores_on, "the finest mesh of the emulator");
  EXPECT_EQ(compare_calibrations(none).scores_on, "");
  Json other = corrected;
  other["scores_on"] = "half the element size";
  const std::vector<MethodSummary> unlike{{"enc", corrected}, {"spe", other}};
  EXPECT_EQ(compare_calibrations(unlike).scores_on, "the case's own mesh");
  EXPECT_THAT(compare_calibrations(unlike).accuracy[0].values, ElementsAre(71, 71));
}

TEST(Comparison, MeasuresDifferencesInStandardDeviationsOfMap) {
  const std::vector<MethodSummary> all{{"enc", summary(13300, 1400, 85, 75)}, {"map", map_summary(13400, 1390)}};
  const auto c = compare_calibrations(all);
  ASSERT_EQ(c.pairs.size(), 1u);
  EXPECT_NEAR(*c.pairs[0].differences[0].in_map_sd, 1, 1e-12);
  EXPECT_NEAR(*c.pairs[0].differences[1].in_map_sd, -1, 1e-12);
  EXPECT_NEAR(*c.pairs[0].differences[0].percent, 100 * 100.0 / 13300, 1e-12);
  EXPECT_TRUE(c.agree);
  EXPECT_THAT(c.sentence, HasSubstr("agree within 2"));
}

TEST(Comparison, AnAnswerAcrossTheRidgeIsADisagreementThoughEachParameterIsWithinItsSd) {
  // +1.5 sd in both: each parameter passes, the impedance does not.
  const std::vector<MethodSummary> all{{"enc", summary(13400 + 150, 1390 + 15, 85, 75)}, {"map", map_summary(13400, 1390)}};
  const auto c = compare_calibrations(all);
  EXPECT_LT(std::abs(*c.pairs[0].differences[0].in_map_sd), 2);
  EXPECT_LT(std::abs(*c.pairs[0].differences[1].in_map_sd), 2);
  EXPECT_GT(std::abs(*c.pairs[0].differences[2].in_map_sd), 4);
  EXPECT_FALSE(c.agree);
  EXPECT_THAT(c.sentence, testing::AllOf(HasSubstr("disagree"), HasSubstr("MAP against ENC"), HasSubstr("impedance"), Not(HasSubstr("density ("))));
}

TEST(Comparison, TellsADisagreementInTheTwoMethodsOwnDeviationsToo) {
  // Both report 100 of density: 250 apart are 2.5 of MAP's and 2.5 / sqrt 2 of the two's; who reports none is told in MAP's alone.
  const std::vector<MethodSummary> all{{"spe", map_summary(13650, 1390)}, {"map", map_summary(13400, 1390)}}, alone{{"spe", summary(13650, 1390, 85, 75)}, {"map", map_summary(13400, 1390)}};
  const auto c = compare_calibrations(all), without = compare_calibrations(alone);
  EXPECT_NEAR(*c.pairs[0].differences[0].in_own_sds, -2.5 / std::sqrt(2.0), 1e-12);
  EXPECT_THAT(c.sentence, HasSubstr("density (-2.5 sd, -1.8 of the two's own, -1.8 %)"));
  EXPECT_FALSE(without.pairs[0].differences[0].in_own_sds.has_value());
  EXPECT_THAT(without.sentence, HasSubstr("density (-2.5 sd, -1.8 %)"));
  EXPECT_NEAR(comparison_json(c, {.stage = "comparison"})["agreement"][0]["differences"][0]["in_own_sds"].get<double>(), -2.5 / std::sqrt(2.0), 1e-12);
}

TEST(Comparison, WithoutMapItDoesNotClaimAgreement) {
  const std::vector<MethodSummary> all{{"enc", summary(13300, 1400, 85, 75)}, {"spe", summary(13300, 1400, 85, 75)}};
  const auto c = compare_calibrations(all);
  EXPECT_FALSE(c.agree);
  EXPECT_THAT(c.sentence, HasSubstr("cannot be told"));
  EXPECT_EQ(c.pairs[0].differences[0].percent, 0);
  EXPECT_FALSE(c.pairs[0].differences[0].in_map_sd.has_value());
}

TEST(Comparison, WhatAnArtefactDoesNotTellStaysOpen) {
  Json without = summary(13300, 1400, 85, 75);
  without["sensors"].erase(1), without["accuracy"] = nullptr, without.erase("impedance");
  const std::vector<MethodSummary> all{{"spe", without}, {"map", map_summary(13400, 1390)}};
  const auto c = compare_calibrations(all);
  EXPECT_FALSE(c.accuracy[1].values[0].has_value());
  EXPECT_EQ(c.accuracy[1].values[1], 80);
  EXPECT_FALSE(c.accuracy[2].values[0].has_value());
  EXPECT_FALSE(c.pairs[0].differences[2].absolute.has_value());
  const Json j = comparison_json(c, {.stage = "comparison"});
  EXPECT_TRUE(j["accuracy"][1]["spe"].is_null());
  EXPECT_EQ(j["accuracy"][1]["map"], 80);
  EXPECT_TRUE(j["agreement"][0]["differences"][2]["in_map_sd"].is_null());
}

TEST(Comparison, TheTextAlignsItsNumbersUnderTheirHeads) {
  const std::vector<MethodSummary> all{{"enc", summary(13300, 1400, 85, 75)}, {"spe", summary(13350, 1410, 86, 70)}, {"map", map_summary(13400, 1390)}};
  const std::string text = comparison_text(compare_calibrations(all));
  for (const char* part : {"parameter", "nominal", "ENC", "SPE", "MAP", "sd by MAP", "impedance", "accuracy [%]", "mae [microstrain]", "MAP - ENC", "+0.38 %"})
    EXPECT_THAT(text, HasSubstr(part));
  std::vector<std::size_t> ends;
  std::size_t at = 0;
  for (int line = 0; line < 4; ++line) {
    const auto end = text.find('\n', at);
    ends.push_back(end - at);
    at = end + 1;
  }
  EXPECT_THAT(ends, testing::Each(ends[0]));
}

}  // namespace
}  // namespace calomel
