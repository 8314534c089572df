#include "apps/presentation/fit_words.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "apps/presentation/calibration_lines.hpp"
#include "apps/presentation/posterior_lines.hpp"
#include "tests/unit/inverse/map/fitted.hpp"

namespace calomel {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double step = 1e-6;
constexpr std::size_t times = 120;

/// y = a + b t on the unit interval, normal priors.
AnalyticModel line() {
  return {
      {normal_parameter("a", 0, 2), normal_parameter("b", 1, 3)}, {[](auto theta, double t) { return theta[0] + theta[1] * t / (step * times); }}, times, step};
}

RecordingOptions noise_of(double sd) {
  RecordingOptions o;
  o.noise = sd;
  return o;
}

GoodnessOfFit goodness() {
  return {.values = 50,
          .parameters = 2,
          .chi2 = 43.21,
          .effective_data = 48.4,
          .effective_chi2 = 41.9,
          .p_value = 0.68,
          .effective_p_value = 0.63,
          .chi2_critical = 73.68,
          .adequate = true};
}

}  // namespace

TEST(FitWords, AFitIsAdequateOrNotOrItsErrorsAreTooWide) {
  GoodnessOfFit g = goodness();
  EXPECT_EQ(goodness_sentence(g),
            "the records do not contradict the fit: chi-squared 43.21 for 50 values less 2 parameters (p 0.68), 41.9 for 48.4 effective data (p 0.63)");
  g.errors_too_wide = true;
  g.chi2 = 12;
  EXPECT_EQ(goodness_sentence(g),
            "the records do not contradict the fit: chi-squared 12 for 50 values less 2 parameters (p 0.68), 41.9 for 48.4 effective data (p 0.63); the errors "
            "taken for granted are 2 times as wide as the residuals, and chi-squared would have spoken only above 73.68: it has not seen what adds less than "
            "61.7 to it");
  g.adequate = false;
  EXPECT_EQ(goodness_sentence(g),
            "the fit is not adequate: the model omits more than noise and known errors explain: chi-squared 12 for 50 values less 2 parameters (p 0.68), "
            "41.9 for 48.4 effective data (p 0.63)");
}

TEST(FitWords, AnEmulatorHasSettledOrNot) {
  Settling s{.settled = true, .coarse = 48, .fine = 14, .moved = 0.05, .variance = 0.1};
  EXPECT_EQ(settling_text(s), "settled after 48 coarse and 14 fine runs");
  s = {.settled = false, .coarse = 48, .fine = 14, .moved = 1.234, .variance = 0.567};
  EXPECT_EQ(settling_text(s),
            "not settled after 48 coarse and 14 fine runs: the mode moved by 1.2 standard deviations in the last round, the emulator's variance is 0.57 of one "
            "run's noise");
}

TEST(FitWords, TheDataPinSomeProductsAndLeaveOthersFree) {
  Identification id;
  EXPECT_EQ(identification_sentence(id), "no parameter is positive, so that products of powers have no meaning here");
  id.directions = {{.data_sd = 0.0123, .pinned = true, .product = "density^0.71 sound_speed^0.70"},
                   {.data_sd = 0.5, .product = "density^0.70 sound_speed^-0.71"}};
  EXPECT_EQ(identification_sentence(id),
            "the data pin density^0.71 sound_speed^0.70 (sd 1.2 %) and leave free density^0.70 sound_speed^-0.71 (sd a factor of 1.6)");
  id.directions[1].pinned = true;
  EXPECT_EQ(identification_sentence(id),
            "the data pin density^0.71 sound_speed^0.70 (sd 1.2 %), density^0.70 sound_speed^-0.71 (sd a factor of 1.6) and leave no combination free");
  id.directions = {{.data_sd = std::numeric_limits<double>::infinity(), .product = "tensile_cutoff^1.00"}};
  EXPECT_EQ(identification_sentence(id), "the data pin no combination much better than was known before; least of all tensile_cutoff^1.00");
  id.directions.insert(id.directions.begin(), {.data_sd = 0.02, .pinned = true, .product = "density^1.00"});
  EXPECT_EQ(identification_sentence(id), "the data pin density^1.00 (sd 2 %) and leave free tensile_cutoff^1.00 (they say nothing of it)");
}

TEST(FitWords, TheResidualPointsSomewhereOrNot) {
  ScoreTests tests;
  EXPECT_EQ(score_test_sentence(tests), "");
  tests.mechanisms = {{.name = "damping", .directions = 2, .f = 1.234, .counts = false},
                      {.name = "interface", .directions = 2, .f = 21.34, .f_of_runs = 1.26, .keys = {{.name = "gap", .value = 0.0123, .sd = 0.0015}}},
                      {.name = "gauge_gains", .directions = 3, .f = 0.9}};
  tests.p_value = 0.31;
  EXPECT_EQ(
      score_test_sentence(tests),
      "whatever the covariance's scale, the residual does not point where one of these would show: interface, gauge_gains (least p 0.31); what else may be "
      "missing was not looked for");
  tests.p_value = 2e-5;
  tests.stands_out = true;
  EXPECT_EQ(score_test_sentence(tests),
            "whatever the covariance's scale, the residual points where interface would show (F 21.3 for 2 directions, p 2e-05 of 2 sets, to first order gap "
            "0.0123 ± 0.0015): enable it, fit anew and compare (map.compare_with)");
  tests.mechanisms.erase(tests.mechanisms.begin() + 1);
  tests.mechanisms[1].f_of_runs = 0.97;
  tests.with_runs = true;
  EXPECT_EQ(
      score_test_sentence(tests),
      "whatever the covariance's scale, amplitudes of single gauges do not fit together (F 0.9 for 3 directions, 0.97 at runs where nothing is missing, p "
      "2e-05 of 1 sets): the load, gauges, or the answer itself may be off by more than its standard deviations");
}

TEST(FitWords, ACheckHoldsOrNotOrWasNotMade) {
  TrueModelCheck check;
  EXPECT_EQ(check_sentence(check), "no run of the true model was requested (emulator.check_coarse, check_fine): the emulator was not checked");
  check.runs.resize(4);
  EXPECT_EQ(check_sentence(check), "no run of the true model succeeded at the posterior's draws: the emulator was not checked");
  check.done = 4;
  check.score = 4;
  check.score_sd = 0.12;
  check.p_value = 2e-5;
  const std::string numbers =
      "4 runs of the true model at the mode and at draws lie 2 times as far from the emulator as it promises (mean square 4, expected 1 ± 0.12, p 2e-05)";
  EXPECT_EQ(check_sentence(check), numbers + ": its deviations are too small there; give it more runs (emulator.rounds, emulator.round_fine)");
  check.holds = true;
  EXPECT_EQ(check_sentence(check), numbers);
}

TEST(FitWords, ANestedModelIsFavouredOrNotOrTheRecordsDoNotDecide) {
  NestedModel n{.name = "small.out",
                .added = {"c", "d"},
                .log_bayes_factor = 5.5,
                .low = 4.8,
                .high = 6.2,
                .values = 120,
                .chi2 = 118.2,
                .nested_chi2 = 140.7,
                .verdict = NestedVerdict::added_favoured};
  EXPECT_EQ(nested_sentence(n),
            "the records favour c and d over small.out by odds of at least 1.2e+02 to 1 (log Bayes factor 5.5, between 4.8 and 6.2 with priors twice and half "
            "as wide; chi-squared 118.2 with and 140.7 without for 120 values)");
  n.verdict = NestedVerdict::added_not_favoured;
  n.log_bayes_factor = -5.5;
  n.low = -6.2;
  n.high = -4.8;
  EXPECT_EQ(nested_sentence(n),
            "the records speak against c and d: small.out is favoured by odds of at least 1.2e+02 to 1 (log Bayes factor -5.5, between -6.2 and -4.8 with "
            "priors twice and half as wide; chi-squared 118.2 with and 140.7 without for 120 values)");
  n.verdict = NestedVerdict::undecided;
  EXPECT_EQ(nested_sentence(n),
            "the records do not decide between small.out and a model with c and d as well (log Bayes factor -5.5, between -6.2 and -4.8 with priors twice and "
            "half as wide; chi-squared 118.2 with and 140.7 without for 120 values)");
}

TEST(FitWords, RefinementsEndForOneOfFourReasons) {
  EXPECT_EQ(refinement_end(RefinementEnd::holds), "the true model agrees with the emulator");
  EXPECT_EQ(refinement_end(RefinementEnd::unchecked), "no run of the true model succeeded, so it was not checked");
  EXPECT_EQ(refinement_end(RefinementEnd::none_allowed), "none was requested (posterior.refinements)");
  EXPECT_EQ(refinement_end(RefinementEnd::limit), "there are no more to be made (posterior.refinements)");
}

TEST(FitWords, AModeWithoutDoubtsHasAMessageAndNoWarning) {
  const auto model = line();
  Fitted f(model, pulses_of(model, {0.7, -1.2}, {.pulses = 1, .noise = 0.05}, 4), noise_of(0.05));
  MapSummary s = f.map({0, 0}, {2, 4});
  EXPECT_THAT(map_warnings(s, f.in, f.fit), IsEmpty());
  s.log_likelihood = 12.5;
  s.log_prior = -2;
  EXPECT_EQ(map_message(s, f.fit), "log posterior 10.5 on the emulator, which " + settling_text(f.fit.settling()) + "; " + goodness_sentence(s.fit));
  const MapWords words = map_words(s, f.fit);
  EXPECT_EQ(words.adequacy, goodness_sentence(s.fit));
  EXPECT_EQ(words.check, check_sentence(s.check));
  EXPECT_EQ(words.nested, "");
  EXPECT_EQ(words.calibration.meaning, meaning_sentence("tuned"));
  EXPECT_EQ(words.identified, identification_sentence(s.identification));
  EXPECT_EQ(words.score_tests, "");
  EXPECT_EQ(words.emulator, settling_text(f.fit.settling()));
}

TEST(FitWords, EveryDoubtAboutAModeIsAWarningInOrder) {
  const auto model = line();
  auto recordings = pulses_of(model, {0.7, -1.2}, {.pulses = 1, .noise = 0.05}, 4);
  for (std::size_t t = 0; t < times; ++t) recordings.values[t] += 0.3 * std::sin(0.2 * double(t));
  Fitted f(model, recordings, noise_of(0.05));
  f.in.emulator.rounds = 0;
  MapSummary s = f.map({0, 0}, {2, 4});
  EXPECT_THAT(map_warnings(s, f.in, f.fit), Contains(goodness_sentence(s.fit)));
  f.fit.settled = false;
  s.check.holds = false;
  s.nuisances = {{.name = "viscosity", .value = 12.345, .deviation = -0.9}, {.name = "beyond", .value = 1.5, .deviation = -2.5}};
  f.problem.shape.parameters[0].max = s.theta[0] = 3.25;
  f.problem.shape.parameters[1].min = s.theta[1] - 1;
  f.problem.shape.parameters[1].max = s.theta[1] + 1.5 * std::sqrt(s.covariance(1, 1));
  EXPECT_THAT(
      map_warnings(s, f.in, f.fit),
      ElementsAre(emulator_sentence(f.fit), check_sentence(s.check), goodness_sentence(s.fit),
                  "the records shift the multiple of the last mesh difference beyond the finest mesh to 1.5, 2.5 standard deviations from its prior mean: "
                  "it may compensate for an effect that the model omits",
                  "a = 3.25 lies on a bound: its best value is beyond the bound, or the data do not determine it",
                  "a bound of b lies within two standard deviations: its interval and the evidence are those of a density that reaches beyond"));
}

TEST(FitWords, AModeThatNoRunVerifiesHasAReason) {
  const auto model = line();
  Fitted f(model, pulses_of(model, {0.7, -1.2}, {.pulses = 1, .noise = 0.05}, 4), noise_of(0.05));
  (void)f.map({0, 0}, {2, 4});
  f.in.run = [](const Eigen::MatrixXd&, const std::vector<int>& level) { return std::vector<RunRecord>(level.size(), {.message = "the step collapsed"}); };
  const MapSummary failed = run_map(f.in, f.fit, "tuned", {}, nullptr);
  EXPECT_EQ(map_message(failed, f.fit), "the true model failed at the mode, which is the emulator's alone: the step collapsed");
  EXPECT_THAT(map_warnings(failed, f.in, f.fit), Contains(map_message(failed, f.fit)));
}

TEST(FitWords, RecordsThatDriftAreAWarning) {
  const auto model = line();
  auto recordings = pulses_of(model, {0.7, -1.2}, {.pulses = 8, .noise = 0.05}, 4);
  for (std::size_t p = 0; p < 8; ++p)
    for (std::size_t t = 0; t < times; ++t) recordings.values[recordings.at(0, 0, p, t)] += p < 4 ? 0.2 : -0.2;
  Fitted f(model, recordings, RecordingOptions{});
  const MapSummary s = f.map({0, 0}, {2, 4});
  ASSERT_GT(f.fit.errors->noise().split_half, 2);
  const auto warnings = map_warnings(s, f.in, f.fit);
  ASSERT_FALSE(warnings.empty());
  EXPECT_THAT(warnings.back(), ::testing::MatchesRegex("early and late pulses differ [0-9.e+]+ times more than independent pulses would: the records drift"));
}

}  // namespace calomel
