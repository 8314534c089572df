#include "uq/convergence/assess.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/json.hpp"
#include "base/not_finite.hpp"
#include "tests/unit/uq/convergence/chains.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Assess, EnergiesThatChangeTooSlowlyAndDivergencesAreTold) {
  const auto good = draws_of({"rho", "c"}, 4, {chains_of(4, 1000), chains_of(4, 1000, 0.2)});
  const auto slow = assess(good, {.e_bfmi = {0.9, 0.21, 0.8, 1.0}, .transitions = 4000});
  EXPECT_FALSE(slow.converged);
  EXPECT_THAT(slow.message, HasSubstr("chain 2 (E-BFMI 0.21)"));
  EXPECT_THAT(slow.message, HasSubstr("c is the parameter"));
  const auto told = assess(good, {.e_bfmi = {0.9, 0.7, 0.8, 1.0}, .divergences = 3, .transitions = 4000});
  EXPECT_TRUE(told.converged);
  EXPECT_THAT(told.message, HasSubstr("3 of 4000 trajectories diverged"));
  const Json j = convergence_json(told);
  EXPECT_EQ(j["divergences"], 3);
  EXPECT_EQ(j["e_bfmi"].size(), 4u);
  EXPECT_GT(j["parameters"][0]["mcse_q95"], j["parameters"][0]["mcse_q50"]);
  EXPECT_FALSE(convergence_json(assess(good)).contains("e_bfmi"));
}

TEST(Assess, NamesTrajectoriesThatDivergeOrEndTooEarly) {
  const auto poor = draws_of({"tau"}, 4, {chains_of(4, 500, 0.98)});
  EXPECT_THAT(assess(poor, {.divergences = 40, .transitions = 2000}).message, HasSubstr("40 of 2000 trajectories diverged"));
  EXPECT_THAT(assess(poor, {.cut = 1000, .transitions = 2000}).message, HasSubstr("50 % of the trajectories are ended by sampler.nuts.depth"));
  EXPECT_THAT(assess(poor, {.divergences = 1, .cut = 10, .transitions = 2000}).message, Not(HasSubstr("trajectories")));  // too few to be the cause
}

TEST(Assess, NextStepsAreThoseOfTheSampler) {
  const auto poor = draws_of({"rho"}, 4, {chains_of(4, 500, 0.98)});
  EXPECT_THAT(assess(poor, {.acceptance = 0.3, .remedies = {.correlation_key = "sampler.smc.correlation"}}).message, HasSubstr("halve sampler.smc.correlation"));
  EXPECT_THAT(assess(poor, {.acceptance = 0.1, .remedies = {.emulator_only = "dram"}}).message, HasSubstr("refuses 90 % of what the emulator proposes"));
  EXPECT_THAT(assess(poor, {.acceptance = 0.5, .remedies = {.emulator_only = "dram"}}).message, Not(HasSubstr("refuses")));
}

TEST(Assess, IndependentDrawsHaveConverged) {
  const auto c = assess(draws_of({"rho", "c"}, 4, {chains_of(4, 1000), chains_of(4, 1000, 0.2)}));
  EXPECT_TRUE(c.converged) << c.message;
  EXPECT_THAT(c.message, HasSubstr("converged"));
  const Json j = convergence_json(c);
  EXPECT_EQ(j["parameters"].size(), 2u);
  for (const char* key : {"name", "mean", "sd", "q05", "q50", "q95", "r_hat", "ess_bulk", "ess_tail", "mcse_mean"})
    EXPECT_TRUE(j["parameters"][0].contains(key)) << key;
  EXPECT_TRUE(j["converged"].get<bool>());
}

TEST(Assess, NamesChainsInDifferentModes) {
  const auto x = chains_of(4, 1000, 0.3, [](std::size_t c, std::size_t) { return c % 2 ? 30.0 : 10.0; });
  const auto c = assess(draws_of({"c", "rho"}, 4, {chains_of(4, 1000), x}));
  EXPECT_FALSE(c.converged);
  EXPECT_EQ(c.parameter, "rho");
  EXPECT_THAT(c.message, HasSubstr("chains 1 and 3"));
  EXPECT_THAT(c.message, HasSubstr("chains 2 and 4"));
  EXPECT_THAT(c.message, HasSubstr("modes"));
  EXPECT_THAT(c.message, HasSubstr("narrow the bounds"));
  // Of many walkers only a few are listed.
  const auto many = assess(draws_of({"rho"}, 40, {chains_of(40, 100, 0.3, [](std::size_t k, std::size_t) { return k % 2 ? 30.0 : 10.0; })}));
  EXPECT_THAT(many.message, HasSubstr("chains 1, 3, 5 and 17 more"));
}

TEST(Assess, NamesADriftForWhatItIs) {
  const auto x = chains_of(4, 900, 0.3, [](std::size_t, std::size_t i) { return double(i) / 100; });
  const auto c = assess(draws_of({"rho"}, 4, {x}));
  EXPECT_FALSE(c.converged);
  EXPECT_THAT(c.message, HasSubstr("drifts"));
  EXPECT_THAT(c.message, HasSubstr("sampler.warmup"));
}

TEST(Assess, NamesTheRidgeAndItsPartner) {
  auto rho = chains_of(4, 1000, 0.99);
  const auto noise = chains_of(
      4, 1000, 0, [](std::size_t, std::size_t) { return 0.0; }, 99);
  std::vector<double> c;
  for (std::size_t i = 0; i < rho.size(); ++i) c.push_back(1450 - 10 * rho[i] + 0.5 * noise[i]);
  const auto verdict = assess(draws_of({"sigma_c", "rho", "c"}, 4, {chains_of(4, 1000), rho, c}), {.acceptance = 0.3});
  EXPECT_FALSE(verdict.converged);
  EXPECT_THAT(verdict.message, HasSubstr("ridge"));
  EXPECT_THAT(verdict.message, HasSubstr("rho"));
  EXPECT_THAT(verdict.message, HasSubstr("correlation -0.99"));
  EXPECT_THAT(verdict.message, Not(HasSubstr("sigma_c")));
}

TEST(Assess, NamesProposalsThatAreRefused) {
  const auto c = assess(draws_of({"rho"}, 4, {chains_of(4, 500, 0.98)}), {.acceptance = 0.01});
  EXPECT_THAT(c.message, HasSubstr("1.0 % of the transitions"));
}

TEST(Assess, TooFewDrawsComesWithTheNumberThatIsEnough) {
  const auto c = assess(draws_of({"rho"}, 4, {chains_of(4, 1000, 0.9)}), {.acceptance = 0.3});
  EXPECT_FALSE(c.converged);
  EXPECT_THAT(c.message, HasSubstr("set sampler.draws = "));
  const auto longer = assess(draws_of({"rho"}, 4, {chains_of(4, 4000, 0.9)}), {.acceptance = 0.3});  // as it said, about
  EXPECT_TRUE(longer.converged) << longer.message;
}

// Many short chains, each with few independent draws: their effective sizes are plenty together while R-hat is not there yet.
TEST(Assess, ShortChainsAreToldHowLongTheyShouldBe) {
  const auto c = assess(draws_of({"rho"}, 80, {chains_of(80, 100, 0.6)}));
  EXPECT_FALSE(c.converged);
  EXPECT_GT(c.parameters[0].ess_bulk, 400);
  EXPECT_THAT(c.message, HasSubstr("set sampler.draws = "));
  const double draws = std::stod(c.message.substr(c.message.find("sampler.draws = ") + 16));
  EXPECT_GT(draws, 100);
  const auto longer = assess(draws_of({"rho"}, 80, {chains_of(80, std::size_t(draws), 0.6)}));
  EXPECT_TRUE(longer.converged) << longer.message;
}

TEST(Assess, ChainsThatDoNotMoveAndNumbersThatAreNoneAreNotConverged) {
  const std::vector<double> same(4000, 3.0);
  EXPECT_THAT(assess(draws_of({"rho"}, 4, {same})).message, HasSubstr("has not moved: all draws are 3"));
  auto one = chains_of(4, 1000);
  for (std::size_t i = 2000; i < 3000; ++i) one[i] = 0.1;
  const auto stuck = assess(draws_of({"rho"}, 4, {one}));
  EXPECT_FALSE(stuck.converged);
  EXPECT_THAT(stuck.message, HasSubstr("chain 3"));
  // One walker of many hides from R-hat.
  auto many = chains_of(80, 1000);
  for (std::size_t i = 0; i < 1000; ++i) many[5000 + i] = 0.68;
  const auto hidden = assess(draws_of({"c", "rho"}, 80, {chains_of(80, 1000), many}));
  EXPECT_LT(hidden.parameters[1].r_hat, 1.01);
  EXPECT_FALSE(hidden.converged);
  EXPECT_EQ(hidden.parameter, "rho");
  EXPECT_THAT(hidden.message, HasSubstr("rho has not moved in chain 6"));
  auto x = chains_of(4, 1000);
  x[3] = calomel::nan;
  const auto c = assess(draws_of({"c", "rho"}, 4, {chains_of(4, 1000), x}));
  EXPECT_FALSE(c.converged);
  EXPECT_EQ(c.parameter, "rho");
  EXPECT_THAT(c.message, HasSubstr("not finite"));
  EXPECT_TRUE(convergence_json(c)["parameters"][1]["r_hat"].is_null());
}

TEST(Assess, LongTailsSeldomVisitedAreTold) {
  // A bulk that mixes and a tail that is entered once in a while and stays.
  auto x = chains_of(4, 2000);
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t i = 0; i < 60; ++i) x[c * 2000 + k * 1000 + 300 + i] = 5 + 0.01 * double(i % 7);
  const auto verdict = assess(draws_of({"tau"}, 4, {x}), {.acceptance = 0.3});
  EXPECT_FALSE(verdict.converged);
  EXPECT_THAT(verdict.message, HasSubstr("tau")) << verdict.message;
}
