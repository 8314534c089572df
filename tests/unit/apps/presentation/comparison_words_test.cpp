// The sentence and the tables about calibrations side by side.
#include "apps/presentation/comparison_words.hpp"

#include <gmock/gmock.h>

namespace calomel {
namespace {

/// ENC and MAP, which differ by `sds` standard deviations of MAP in the density, at a place in the posterior.
Comparison two(double sds, PlaceInPosterior place) {
  const double density = 13400 - 100 * sds;
  return {.methods = {"enc", "map"},
          .parameters = {{.name = "density", .nominal = 13500, .values = {density, 13400}, .map_sd = 100},
                         {.name = "sound_speed", .nominal = 1450, .values = {1390, std::nullopt}}},
          .accuracy = {{.name = "mean", .nominal = 60, .values = {80, 85}}},
          .mae = {{.name = "mean", .nominal = std::nullopt, .values = {10, 9}}},
          .mae_unit = "microstrain",
          .pairs = {{.first = "enc",
                     .second = "map",
                     .differences = {{.name = "density", .absolute = 100 * sds, .percent = 100 * 100 * sds / density, .in_map_sd = sds},
                                     {.name = "sound_speed", .absolute = {}, .percent = {}, .in_map_sd = {}}}}},
          .in_posterior = {std::move(place)}};
}

TEST(ComparisonWords, AnAnswerLiesWithinThePosteriorOrOutsideItOrItsPlaceIsNotKnown) {
  Comparison c = two(1, {.method = "enc", .distance = 1.5, .share_nearer = 0.69});
  EXPECT_EQ(comparison_sentence(c), "ENC lies within the posterior (1.5 deviations from its mode, 69 % of it nearer).");
  c = two(2.5, {.method = "enc", .distance = 3.2, .share_nearer = 0.994});
  c.in_posterior.push_back({.method = "spe", .distance = {}, .share_nearer = {}});
  EXPECT_EQ(comparison_sentence(c),
            "ENC lies outside the posterior: 3.2 deviations from its mode, 99.4 % of it nearer, density -2.5 sd (-1.9 %); SPE's place in the posterior is not "
            "known.");
  c = two(1, {.method = "enc", .distance = 6.7, .share_nearer = 0.99999});
  EXPECT_EQ(comparison_sentence(c), "ENC lies outside the posterior: 6.7 deviations from its mode, more than 99.9 % of it nearer.");
  c.in_posterior.clear();
  EXPECT_EQ(comparison_sentence(c), "Whether the methods agree is not known without MAP's covariance; the differences in percent are listed.");
}

TEST(ComparisonWords, TheTablesAlignTheirNumbersUnderTheirHeads) {
  Comparison c = two(1, {.method = "enc", .distance = 1.5, .share_nearer = 0.69});
  c.scores_on = "the case's own mesh";
  EXPECT_EQ(comparison_text(c), R"(  parameter    nominal    ENC    MAP  sd by MAP
  density        13500  13300  13400        100
  sound_speed     1450   1390      -          -

  accuracy [%]  nominal   ENC   MAP
  mean             60.0  80.0  85.0

  mae [microstrain]  nominal    ENC   MAP
  mean                     -  10.00  9.00
  (accuracy and mae on the case's own mesh)

  difference            MAP - ENC
  density      +0.75 % = +1.00 sd
  sound_speed                   -

  in the posterior  deviations from its mode  share nearer [%]
  ENC                                   1.50              69.0
  ENC lies within the posterior (1.5 deviations from its mode, 69 % of it nearer).)");
}

}  // namespace
}  // namespace calomel
