#include "apps/presentation/posterior_lines.hpp"

#include <gmock/gmock.h>

#include "apps/presentation/convergence_words.hpp"
#include "apps/presentation/fit_words.hpp"

using namespace calomel;
using testing::ElementsAre;

TEST(PosteriorLines, ARoundReportsItsRunsTheModeAndTheVariance) {
  PosteriorRound round{.coarse = 48, .fine = 14, .theta = {13310.4, 1462}, .theta_sd = {21.3, 2}, .variance = 0.25};
  const std::vector<Parameter> parameters{{.name = "density"}, {.name = "sound_speed"}};
  EXPECT_EQ(round_line(round, parameters), "emulator: 48 coarse and 14 fine runs: density 13310 ± 21, sound_speed 1462 ± 2; emulator's variance 0.25");
  round.failed = 3;
  EXPECT_EQ(round_line(round, parameters),
            "emulator: 48 coarse and 14 fine runs (3 failed): density 13310 ± 21, sound_speed 1462 ± 2; emulator's variance 0.25");
}

TEST(PosteriorLines, EveryParameterHasALineOfItsDraws) {
  Convergence convergence;
  EXPECT_TRUE(draws_lines(convergence).empty());
  convergence.parameters.push_back({.name = "density", .mean = 13310, .sd = 21, .q05 = 13275, .q50 = 13310, .q95 = 13345, .r_hat = 1.002, .ess_bulk = 2345.6});
  EXPECT_THAT(draws_lines(convergence), ElementsAre("sample: density 13310 ± 21 (90 %: 13275 to 13345; R-hat 1.002, ESS 2346)"));
}

TEST(PosteriorLines, AMeshThatDoesNotResolveTheFrontIsReportedWithOneThatDoes) {
  const auto said = front_sentence(1.016, 1e-3);
  EXPECT_THAT(said, testing::StartsWith("the emulator's finest mesh, 1 mm, has only 1.0 elements through the front of the pulse"));
  EXPECT_THAT(said, testing::HasSubstr("elements of 0.508 mm (emulator.element_sizes)"));
}

TEST(PosteriorLines, AnAbsorptionNamesItsSide) {
  EXPECT_EQ(absorption_sentence("density", -3.14159), "density is 3.1 prior standard deviations below its prior mean: it compensates for an omitted effect");
  EXPECT_THAT(absorption_sentence("density", 2.5), testing::HasSubstr("2.5 prior standard deviations above"));
}

TEST(PosteriorLines, TheVerdictGivesTheGravestReason) {
  Convergence convergence{.finding = {.state = ChainState::short_chains, .draws = 3}, .parameter = "tau"};
  PosteriorFit fit;
  fit.rounds.push_back({.coarse = 48, .fine = 14, .moved = 1.5, .variance = 0.25});
  TrueModelCheck check;
  EXPECT_EQ(verdict_sentence(convergence, fit, check), convergence_sentence(convergence));
  convergence.converged = true;
  convergence.finding.state = ChainState::converged;
  EXPECT_EQ(verdict_sentence(convergence, fit, check), emulator_sentence(fit));
  fit.settled = true;
  EXPECT_EQ(verdict_sentence(convergence, fit, check), check_sentence(check));
  check.holds = true;
  EXPECT_EQ(verdict_sentence(convergence, fit, check), convergence_sentence(convergence));
}

TEST(PosteriorLines, TheInflationNamesItsRangeAndTheParameterOfTheLargest) {
  const NoiseInflation w{.sd_ratio = {1.02, 1.31, 0.98}, .sd_ratio_alike = {}, .shift = {}, .plug_in_draws = 100, .weights = {0.5, 0.5}, .effective_draws = 2};
  EXPECT_EQ(inflation_sentence(w, {"density", "sound_speed", "cutoff"}),
            "averaged over 2 draws of the emulator's noise (2.0 effective): standard deviations are 0.98 to 1.31 times those with its estimate alone, the "
            "largest ratio for sound_speed");
}

TEST(PosteriorLines, RefinementsAreCountedWithTheirRunsAndWhyTheyEnded) {
  RefinedFit fit{.fit = {}, .check = {}, .refinements = {}, .ended = RefinementEnd::holds};
  const std::string why = refinement_end(RefinementEnd::holds);
  EXPECT_EQ(refinement_sentence(fit), "the emulator was not refined: " + why);
  fit.refinements.push_back({.check = {}, .runs = 20});
  EXPECT_EQ(refinement_sentence(fit), "the emulator was refined once by 20 further runs: " + why);
  fit.refinements.push_back({.check = {}, .runs = 7});
  EXPECT_EQ(refinement_sentence(fit), "the emulator was refined 2 times by 27 further runs: " + why);
}

TEST(PosteriorLines, EveryFormOfErrorsHasASentence) {
  EXPECT_EQ(form_sentence("no_mesh_errors"), "the same errors without those of the mesh and without numerical noise");
  EXPECT_EQ(form_sentence("independent"), "independent normal errors of the band's deviation at every sample, without nuisances: the published form");
  EXPECT_THROW((void)form_sentence("unheard of"), ContractFailure);
}

TEST(PosteriorLines, HyperparametersAreHeldAtTheirEstimateForAReason) {
  EXPECT_EQ(estimate_only_reason(default_sampler_options("dram")), "their estimate alone (posterior.hyperparameter_draws)");
  EXPECT_EQ(estimate_only_reason(default_sampler_options("delayed_acceptance")), "delayed acceptance walks on the posterior with their estimate");
}
