#include "uq/convergence/assess.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "base/json.hpp"
#include "base/not_finite.hpp"
#include "tests/unit/uq/convergence/chains.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::ElementsAre;
using ::testing::SizeIs;

namespace {

const SamplerRemedies along_trajectories{.accuracy_key = "sampler.walk.accuracy", .safer_accuracy = 0.95, .length_key = "sampler.walk.length"};

}  // namespace

TEST(Assess, EnergiesThatChangeTooSlowlyAndDivergencesAreFound) {
  const auto good = draws_of({"rho", "c"}, 4, {chains_of(4, 1000), chains_of(4, 1000, 0.2)});
  const auto slow = assess(good, {.e_bfmi = {0.9, 0.21, 0.8, 1.0}, .transitions = 4000});
  EXPECT_FALSE(slow.converged);
  EXPECT_EQ(slow.finding.state, ChainState::slow_energies);
  EXPECT_THAT(slow.finding.chains, ElementsAre(1));
  EXPECT_EQ(slow.finding.e_bfmi, 0.21);
  EXPECT_EQ(slow.parameter, "c");
  const auto diverged = assess(good, {.e_bfmi = {0.9, 0.7, 0.8, 1.0}, .divergences = 3, .transitions = 4000});
  EXPECT_TRUE(diverged.converged);
  EXPECT_EQ(diverged.divergences, 3u);
  EXPECT_EQ(diverged.finding.transitions, 4000u);
  const Json j = convergence_json(diverged, "a sentence");
  EXPECT_EQ(j["divergences"], 3);
  EXPECT_EQ(j["e_bfmi"].size(), 4u);
  EXPECT_EQ(j["message"], "a sentence");
  EXPECT_GT(j["parameters"][0]["mcse_q95"], j["parameters"][0]["mcse_q50"]);
  EXPECT_FALSE(convergence_json(assess(good), "").contains("e_bfmi"));
}

TEST(Assess, FindsTrajectoriesThatDivergeOrEndTooEarly) {
  const auto poor = draws_of({"tau"}, 4, {chains_of(4, 500, 0.98)});
  const auto diverged = assess(poor, {.divergences = 40, .transitions = 2000, .remedies = along_trajectories});
  EXPECT_EQ(diverged.finding.state, ChainState::divergences);
  EXPECT_EQ(diverged.divergences, 40u);
  EXPECT_EQ(diverged.finding.remedies.accuracy_key, "sampler.walk.accuracy");
  const auto cut = assess(poor, {.cut = 1000, .transitions = 2000, .remedies = along_trajectories});
  EXPECT_EQ(cut.finding.state, ChainState::cut_trajectories);
  EXPECT_EQ(cut.finding.share, 0.5);
  const auto few = assess(poor, {.divergences = 1, .cut = 10, .transitions = 2000}).finding.state;  // too few to be the cause
  EXPECT_NE(few, ChainState::divergences);
  EXPECT_NE(few, ChainState::cut_trajectories);
}

TEST(Assess, CausesAreThoseOfTheSampler) {
  const auto poor = draws_of({"rho"}, 4, {chains_of(4, 500, 0.98)});
  const auto particles = assess(poor, {.acceptance = 0.3, .remedies = {.correlation_key = "sampler.cloud.correlation"}}).finding;
  EXPECT_EQ(particles.state, ChainState::common_ancestors);
  EXPECT_GE(particles.suggested_draws, 1000);
  const auto refused = assess(poor, {.acceptance = 0.1, .remedies = {.emulator_only = "walk"}}).finding;
  EXPECT_EQ(refused.state, ChainState::emulator_disagrees);
  EXPECT_EQ(refused.share, 0.1);
  EXPECT_NE(assess(poor, {.acceptance = 0.5, .remedies = {.emulator_only = "walk"}}).finding.state, ChainState::emulator_disagrees);
}

TEST(Assess, IndependentDrawsHaveConverged) {
  const auto c = assess(draws_of({"rho", "c"}, 4, {chains_of(4, 1000), chains_of(4, 1000, 0.2)}));
  EXPECT_TRUE(c.converged);
  EXPECT_EQ(c.finding.state, ChainState::converged);
  const Json j = convergence_json(c, "");
  EXPECT_EQ(j["parameters"].size(), 2u);
  for (const char* key : {"name", "mean", "sd", "q05", "q50", "q95", "r_hat", "ess_bulk", "ess_tail", "mcse_mean"})
    EXPECT_TRUE(j["parameters"][0].contains(key)) << key;
  EXPECT_TRUE(j["converged"].get<bool>());
}

TEST(Assess, FindsChainsInDifferentModes) {
  const auto x = chains_of(4, 1000, 0.3, [](std::size_t c, std::size_t) { return c % 2 ? 30.0 : 10.0; });
  const auto c = assess(draws_of({"c", "rho"}, 4, {chains_of(4, 1000), x}));
  EXPECT_FALSE(c.converged);
  EXPECT_EQ(c.parameter, "rho");
  EXPECT_EQ(c.finding.state, ChainState::separate_modes);
  EXPECT_THAT(c.finding.chains, ElementsAre(0, 2));
  EXPECT_THAT(c.finding.others, ElementsAre(1, 3));
  EXPECT_NEAR(c.finding.low_at, 10, 0.2);
  EXPECT_NEAR(c.finding.high_at, 30, 0.2);
  const auto many = assess(draws_of({"rho"}, 40, {chains_of(40, 100, 0.3, [](std::size_t k, std::size_t) { return k % 2 ? 30.0 : 10.0; })}));
  EXPECT_THAT(many.finding.chains, SizeIs(20));
}

TEST(Assess, FindsADriftForWhatItIs) {
  const auto x = chains_of(4, 900, 0.3, [](std::size_t, std::size_t i) { return double(i) / 100; });
  const auto c = assess(draws_of({"rho"}, 4, {x}));
  EXPECT_FALSE(c.converged);
  EXPECT_EQ(c.finding.state, ChainState::drift);
}

TEST(Assess, FindsTheRidgeAndItsPartner) {
  auto rho = chains_of(4, 1000, 0.99);
  const auto noise = chains_of(
      4, 1000, 0, [](std::size_t, std::size_t) { return 0.0; }, 99);
  std::vector<double> c;
  for (std::size_t i = 0; i < rho.size(); ++i) c.push_back(1450 - 10 * rho[i] + 0.5 * noise[i]);
  const auto verdict = assess(draws_of({"sigma_c", "rho", "c"}, 4, {chains_of(4, 1000), rho, c}), {.acceptance = 0.3});
  EXPECT_FALSE(verdict.converged);
  EXPECT_EQ(verdict.finding.state, ChainState::ridge);
  EXPECT_NEAR(verdict.finding.correlation, -0.995, 0.005);
  const std::vector<std::string> pair{verdict.parameter, verdict.finding.partner};
  EXPECT_THAT(pair, ::testing::UnorderedElementsAre("rho", "c"));
}

TEST(Assess, FindsProposalsThatAreRefused) {
  const auto c = assess(draws_of({"rho"}, 4, {chains_of(4, 500, 0.98)}), {.acceptance = 0.01});
  EXPECT_EQ(c.finding.state, ChainState::refused_proposals);
  EXPECT_EQ(c.finding.share, 0.01);
}

TEST(Assess, TooFewDrawsComesWithTheNumberThatIsEnough) {
  const auto c = assess(draws_of({"rho"}, 4, {chains_of(4, 1000, 0.9)}), {.acceptance = 0.3});
  EXPECT_FALSE(c.converged);
  EXPECT_GT(c.finding.suggested_draws, 1000);
  const auto longer = assess(draws_of({"rho"}, 4, {chains_of(4, 4000, 0.9)}), {.acceptance = 0.3});  // about as many as were suggested
  EXPECT_TRUE(longer.converged) << int(longer.finding.state);
}

// Many short chains, each with few independent draws: together their effective sizes suffice while R-hat is still too large.
TEST(Assess, ShortChainsComeWithTheLengthThatIsEnough) {
  const auto c = assess(draws_of({"rho"}, 80, {chains_of(80, 100, 0.6)}));
  EXPECT_FALSE(c.converged);
  EXPECT_GT(c.parameters[0].ess_bulk, 400);
  const double draws = c.finding.suggested_draws;
  EXPECT_GT(draws, 100);
  const auto longer = assess(draws_of({"rho"}, 80, {chains_of(80, std::size_t(draws), 0.6)}));
  EXPECT_TRUE(longer.converged) << int(longer.finding.state);
}

TEST(Assess, ChainsThatDoNotMoveAndNumbersThatAreNoneAreNotConverged) {
  const std::vector<double> same(4000, 3.0);
  const auto constant = assess(draws_of({"rho"}, 4, {same})).finding;
  EXPECT_EQ(constant.state, ChainState::constant);
  EXPECT_EQ(constant.value, 3);
  auto one = chains_of(4, 1000);
  for (std::size_t i = 2000; i < 3000; ++i) one[i] = 0.1;
  const auto stuck = assess(draws_of({"rho"}, 4, {one}));
  EXPECT_FALSE(stuck.converged);
  EXPECT_THAT(stuck.finding.chains, ElementsAre(2));
  // One walker of many hides from R-hat.
  auto many = chains_of(80, 1000);
  for (std::size_t i = 0; i < 1000; ++i) many[5000 + i] = 0.68;
  const auto hidden = assess(draws_of({"c", "rho"}, 80, {chains_of(80, 1000), many}));
  EXPECT_LT(hidden.parameters[1].r_hat, 1.01);
  EXPECT_FALSE(hidden.converged);
  EXPECT_EQ(hidden.parameter, "rho");
  EXPECT_EQ(hidden.finding.state, ChainState::still_chains);
  EXPECT_THAT(hidden.finding.chains, ElementsAre(5));
  auto x = chains_of(4, 1000);
  x[3] = calomel::nan;
  const auto c = assess(draws_of({"c", "rho"}, 4, {chains_of(4, 1000), x}));
  EXPECT_FALSE(c.converged);
  EXPECT_EQ(c.parameter, "rho");
  EXPECT_EQ(c.finding.state, ChainState::not_finite);
  EXPECT_TRUE(convergence_json(c, "")["parameters"][1]["r_hat"].is_null());
}

TEST(Assess, LongTailsSeldomVisitedAreFound) {
  // A bulk that mixes and a tail that is entered once in a while and remains.
  auto x = chains_of(4, 2000);
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t i = 0; i < 60; ++i) x[c * 2000 + k * 1000 + 300 + i] = 5 + 0.01 * double(i % 7);
  const auto verdict = assess(draws_of({"tau"}, 4, {x}), {.acceptance = 0.3});
  EXPECT_FALSE(verdict.converged);
  EXPECT_EQ(verdict.parameter, "tau");
}
