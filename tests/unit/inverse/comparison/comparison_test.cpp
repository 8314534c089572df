#include "inverse/comparison/comparison.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <utility>

#include "base/provenance.hpp"

namespace calomel {
namespace {

using ::testing::ElementsAre;

Json summary(double density, double sound_speed, double accuracy_a, double accuracy_b) {
  return {{"theta", {{"density", density}, {"sound_speed", sound_speed}}},
          {"nominal", {{"density", 13500}, {"sound_speed", 1450}}},
          {"impedance", {{"value", density * sound_speed}, {"nominal", 13500.0 * 1450}, {"unit", "kg m-2 s-1"}}},
          {"accuracy", 0.5 * (accuracy_a + accuracy_b)},
          {"nominal_accuracy", 60},
          {"mae", 10},
          {"nominal_mae", 20},
          {"mae_unit", "microstrain"},
          {"sensors",
           {{{"name", "A"}, {"accuracy", accuracy_a}, {"mae", 9}, {"nominal_accuracy", 55}, {"nominal_mae", 19}},
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
  // d(rho c) = c d rho + rho d c; the correlation makes the product far better determined than its factors
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

TEST(Comparison, StandardDeviationsAreMapsAlone) {
  Json enc = summary(13300, 1400, 85, 75);
  enc["parameters"] = {"density", "sound_speed"}, enc["covariance"] = {{9e4, 0}, {0, 400}};  // from an older version, which is not read
  const std::vector<MethodSummary> all{{"enc", enc}, {"map", map_summary(13400, 1390)}}, alone{{"enc", enc}};
  const Json j = comparison_json(compare_calibrations(all), "", {.stage = "comparison"});
  EXPECT_EQ(j["parameters"][0]["map_sd"], 100);
  EXPECT_FALSE(j["parameters"][0].contains("enc_sd"));
  EXPECT_FALSE(compare_calibrations(alone).parameters[0].map_sd.has_value());
}

// A method with mesh-corrected scores is compared with one without on the mesh that both report.
TEST(Comparison, ScoresAreOfOneMesh) {
  const Json plain = summary(13300, 1400, 60, 50);
  Json corrected = summary(13310, 1400, 95, 93);
  corrected["scores_on"] = "the finest mesh of the emulator";
  corrected["mesh"]["working_mesh"] = {{"accuracy", 72},
                                       {"nominal_accuracy", 58},
                                       {"sensors", {{{"name", "A"}, {"accuracy", 71}, {"nominal_accuracy", 54}}, {{"name", "B"}, {"accuracy", 73}}}}};
  const std::vector<MethodSummary> mixed{{"enc", corrected}, {"map", plain}}, alike{{"enc", corrected}, {"spe", corrected}},
      none{{"enc", plain}, {"spe", plain}};
  const auto c = compare_calibrations(mixed);
  EXPECT_THAT(c.accuracy[0].values, ElementsAre(71, 60));
  EXPECT_EQ(c.accuracy[0].nominal, 54);
  EXPECT_THAT(c.accuracy[2].values, ElementsAre(72, 55));
  EXPECT_EQ(c.scores_on, "the case's own mesh");
  EXPECT_THAT(compare_calibrations(alike).accuracy[0].values, ElementsAre(95, 95));
  EXPECT_EQ(compare_calibrations(alike).scores_on, "the finest mesh of the emulator");
  EXPECT_EQ(compare_calibrations(none).scores_on, "");
  Json other = corrected;
  other["scores_on"] = "half the element size";
  const std::vector<MethodSummary> unlike{{"enc", corrected}, {"spe", other}};
  EXPECT_EQ(compare_calibrations(unlike).scores_on, "the case's own mesh");
  EXPECT_THAT(compare_calibrations(unlike).accuracy[0].values, ElementsAre(71, 71));
}

// The scores of MAP are those of runs on the finest mesh; MAP has none on the mesh of the case.
TEST(Comparison, AMethodWithoutScoresOnTheCommonMeshHasNone) {
  Json corrected = summary(13310, 1400, 95, 93), finest = map_summary(13400, 1390);
  corrected["scores_on"] = finest["scores_on"] = "the finest mesh of the emulator";
  corrected["mesh"]["working_mesh"] = {
      {"accuracy", 72}, {"nominal_accuracy", 58}, {"sensors", {{{"name", "A"}, {"accuracy", 71}}, {{"name", "B"}, {"accuracy", 73}}}}};
  const std::vector<MethodSummary> alike{{"enc", corrected}, {"map", finest}}, bare{{"enc", summary(13300, 1400, 60, 50)}, {"map", finest}};
  const auto c = compare_calibrations(alike), without = compare_calibrations(bare);
  EXPECT_EQ(c.scores_on, "the finest mesh of the emulator");
  EXPECT_THAT(c.accuracy[0].values, ElementsAre(95, 90));
  EXPECT_EQ(without.scores_on, "the case's own mesh");
  EXPECT_EQ(without.accuracy[0].values[0], 60);
  EXPECT_FALSE(without.accuracy[0].values[1].has_value());
  EXPECT_FALSE(without.accuracy[2].values[1].has_value());
}

TEST(Comparison, MeasuresDifferencesInStandardDeviationsOfMap) {
  const std::vector<MethodSummary> all{{"enc", summary(13300, 1400, 85, 75)}, {"map", map_summary(13400, 1390)}};
  const auto c = compare_calibrations(all);
  ASSERT_EQ(c.pairs.size(), 1u);
  EXPECT_NEAR(*c.pairs[0].differences[0].in_map_sd, 1, 1e-12);
  EXPECT_NEAR(*c.pairs[0].differences[1].in_map_sd, -1, 1e-12);
  EXPECT_NEAR(*c.pairs[0].differences[0].percent, 100 * 100.0 / 13300, 1e-12);
}

// For deviations a and b with correlation r, d^2 = (a^2 - 2 r a b + b^2) / (1 - r^2), and the share nearer is 1 - exp(-d^2 / 2).
TEST(Comparison, AnAnswerHasItsPlaceInThePosterior) {
  const auto place = [](double a, double b) {
    const std::vector<MethodSummary> all{{"enc", summary(13400 + 100 * a, 1390 + 10 * b, 85, 75)}, {"map", map_summary(13400, 1390)}};
    return compare_calibrations(all);
  };
  const double r = -0.9;
  for (const auto& [a, b] : {std::pair{-1.0, 1.0}, {0.5, -0.2}, {1.5, 1.5}, {0.0, 0.0}}) {
    const auto c = place(a, b);
    const double d2 = (a * a - 2 * r * a * b + b * b) / (1 - r * r);
    ASSERT_EQ(c.in_posterior.size(), 1u);
    EXPECT_EQ(c.in_posterior[0].method, "enc");
    EXPECT_NEAR(*c.in_posterior[0].distance, std::sqrt(d2), 1e-9);
    EXPECT_NEAR(*c.in_posterior[0].share_nearer, 1 - std::exp(-d2 / 2), 1e-9);
    EXPECT_EQ(c.in_posterior[0].outside(), d2 > -2 * std::log(0.01));
    EXPECT_EQ(c.agree, !c.in_posterior[0].outside());
  }
  // The deviations of each parameter are the same in both cases: along the ridge of constant impedance the point is within, across the ridge it is outside.
  EXPECT_FALSE(place(-1.5, 1.5).in_posterior[0].outside());
  EXPECT_TRUE(place(1.5, 1.5).in_posterior[0].outside());
  const Json j = comparison_json(place(-1, 1), "ENC lies within the posterior.", {.stage = "comparison"});
  EXPECT_EQ(j["sentence"], "ENC lies within the posterior.");
  EXPECT_EQ(j["in_posterior"].size(), 1u);
  EXPECT_EQ(j["in_posterior"][0]["method"], "enc");
  EXPECT_NEAR(j["in_posterior"][0]["distance"].get<double>(), std::sqrt(2 / 1.9), 1e-9);
  EXPECT_NEAR(j["in_posterior"][0]["share_nearer"].get<double>(), 1 - std::exp(-1 / 1.9), 1e-9);
}

TEST(Comparison, EveryAnswerButMapsIsPlacedAndOneOutsideIsADisagreement) {
  const std::vector<MethodSummary> all{{"enc", summary(13350, 1395, 85, 75)}, {"spe", summary(13000, 1390, 86, 70)}, {"map", map_summary(13400, 1390)}};
  const auto c = compare_calibrations(all);
  ASSERT_EQ(c.in_posterior.size(), 2u);
  EXPECT_FALSE(c.in_posterior[0].outside());
  EXPECT_TRUE(c.in_posterior[1].outside());
  EXPECT_FALSE(c.agree);
  EXPECT_NEAR(*c.in_posterior[1].distance, 9.18, 0.01);
}

TEST(Comparison, APlaceThatCannotBeToldIsNotAgreement) {
  Json flat = map_summary(13400, 1390), partial = summary(13400, 1390, 85, 75);
  flat["covariance"] = {{1e4, 1e3}, {1e3, 100}};  // singular
  partial["theta"].erase("sound_speed");
  const std::vector<MethodSummary> singular{{"enc", summary(13300, 1400, 85, 75)}, {"map", flat}}, missing{{"enc", partial}, {"map", map_summary(13400, 1390)}};
  for (const auto& all : {singular, missing}) {
    const auto c = compare_calibrations(all);
    ASSERT_EQ(c.in_posterior.size(), 1u);
    EXPECT_FALSE(c.in_posterior[0].distance.has_value());
    EXPECT_FALSE(c.agree);
    EXPECT_TRUE(comparison_json(c, "", {.stage = "comparison"})["in_posterior"][0]["share_nearer"].is_null());
  }
}

TEST(Comparison, WithoutMapItDoesNotClaimAgreement) {
  const std::vector<MethodSummary> all{{"enc", summary(13300, 1400, 85, 75)}, {"spe", summary(13300, 1400, 85, 75)}};
  const auto c = compare_calibrations(all);
  EXPECT_FALSE(c.agree);
  EXPECT_EQ(c.pairs[0].differences[0].percent, 0);
  EXPECT_FALSE(c.pairs[0].differences[0].in_map_sd.has_value());
  EXPECT_TRUE(c.in_posterior.empty());
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
  const Json j = comparison_json(c, "", {.stage = "comparison"});
  EXPECT_TRUE(j["accuracy"][1]["spe"].is_null());
  EXPECT_EQ(j["accuracy"][1]["map"], 80);
  EXPECT_TRUE(j["agreement"][0]["differences"][2]["in_map_sd"].is_null());
}

}  // namespace
}  // namespace calomel
