#include "apps/presentation/convergence_words.hpp"

#include <gtest/gtest.h>

using namespace calomel;

namespace {

const SamplerRemedies walk{.accuracy_key = "sampler.walk.accuracy", .safer_accuracy = 0.95, .length_key = "sampler.walk.length"};

/// The sentence about tau, which is known worst.
std::string sentence(ConvergenceFinding finding, std::size_t divergences = 0) {
  const bool converged = finding.state == ChainState::converged;
  return convergence_sentence({.converged = converged,
                               .finding = std::move(finding),
                               .parameter = "tau",
                               .parameters = {{.name = "rho"}, {.name = "tau", .r_hat = 1.0312, .ess_bulk = 150, .ess_tail = 90}},
                               .divergences = divergences});
}

}  // namespace

TEST(ConvergenceWords, EveryStateHasItsSentence) {
  EXPECT_EQ(convergence_sentence({}), "not assessed");
  EXPECT_EQ(sentence({.state = ChainState::converged}),
            "converged: tau is the least well known, with R-hat 1.0312, effective sample sizes 150 in the bulk and 90 in the tails");
  EXPECT_EQ(sentence({.state = ChainState::short_chains, .draws = 3}), "tau cannot be judged by 3 draws a chain; set sampler.draws to some thousands");
  EXPECT_EQ(
      sentence({.state = ChainState::not_finite}),
      "tau has draws that are not finite, so the density or its transformation is wrong there; look at them in posterior.nc and narrow the bounds of tau");
  EXPECT_EQ(sentence({.state = ChainState::constant, .value = 3}),
            "tau has not moved: all draws are 3, because every proposal was refused; start from the covariance of calibrate --method map, or raise "
            "sampler.warmup");
  EXPECT_EQ(sentence({.state = ChainState::still_chains, .chains = {5}}),
            "tau has not moved in chain 6 (R-hat 1.031), while other chains did; those started where proposals are refused, so lower sampler.dispersion or "
            "raise sampler.warmup");
  EXPECT_EQ(sentence({.state = ChainState::drift}),
            "tau still drifts in one direction in most chains (R-hat 1.0312, effective sample sizes 150 in the bulk and 90 in the tails), so the warm-up ended "
            "before they had arrived; double sampler.warmup, or start from the mode and covariance of calibrate --method map");
  EXPECT_EQ(
      sentence({.state = ChainState::separate_modes, .chains = {0, 2}, .others = {1, 3}, .low_at = 9.9982, .high_at = 30.003}),
      "tau lies near 9.9982 in chains 1 and 3 and near 30.003 in chains 2 and 4, and no chain goes from one to the other (R-hat 1.03): two modes, whose "
      "weights these draws do not determine; compare the modes (calibrate --method map lists other optima) and narrow the bounds or the prior of tau to the "
      "one that is meant");
  EXPECT_EQ(sentence({.state = ChainState::divergences, .transitions = 2000, .remedies = walk}, 40),
            "tau is not known (R-hat 1.0312, effective sample sizes 150 in the bulk and 90 in the tails) and 40 of 2000 trajectories diverged: the density "
            "bends more sharply somewhere than their steps can follow, as in a funnel, or ends at an edge; raise sampler.walk.accuracy to 0.95, or infer tau "
            "on a logarithmic scale");
  EXPECT_EQ(sentence({.state = ChainState::cut_trajectories, .share = 0.5, .remedies = walk}),
            "tau mixes slowly (R-hat 1.0312, effective sample sizes 150 in the bulk and 90 in the tails) because 50 % of the trajectories are ended by "
            "sampler.walk.length before they turn: scales differ more than the metric corrects; double sampler.warmup, so that it is learnt, or raise "
            "sampler.walk.length");
  EXPECT_EQ(sentence({.state = ChainState::common_ancestors, .suggested_draws = 4000, .remedies = {.correlation_key = "sampler.cloud.correlation"}}),
            "tau differs between populations of particles (R-hat 1.0312, effective sample sizes 150 in the bulk and 90 in the tails), which still have "
            "ancestors in common where they arrive; halve sampler.cloud.correlation, so that they move more, and set sampler.draws = 4000");
  EXPECT_EQ(sentence({.state = ChainState::emulator_disagrees, .share = 0.1, .remedies = {.emulator_only = "walk"}}),
            "tau mixes slowly (R-hat 1.0312, effective sample sizes 150 in the bulk and 90 in the tails) because the true model refuses 90 % of what the "
            "emulator proposes: the two disagree there, or runs carry much numerical noise; give the emulator more runs (emulator.rounds), or take "
            "sampler.kind = \"walk\", whose check by the true model shows by how much they differ");
  EXPECT_EQ(sentence({.state = ChainState::refused_proposals, .share = 0.01}),
            "tau mixes slowly (R-hat 1.0312, effective sample sizes 150 in the bulk and 90 in the tails) because only 1.0 % of the transitions move: the "
            "frozen proposal does not fit the density; raise sampler.warmup, or start from the covariance of calibrate --method map");
  EXPECT_EQ(sentence({.state = ChainState::ridge, .partner = "rho", .correlation = -0.991}),
            "tau mixes slowly (R-hat 1.0312, effective sample sizes 150 in the bulk and 90 in the tails) along the narrow ridge that it forms with rho "
            "(correlation -0.991); give one of the two a prior from elsewhere, or let the proposal learn the ridge: start from the covariance of calibrate "
            "--method map and double sampler.warmup");
  EXPECT_EQ(
      sentence({.state = ChainState::slow_energies, .chains = {1}, .e_bfmi = 0.21}),
      "the energy changes too slowly in chain 2 (E-BFMI 0.21), so that the tails are explored by diffusion alone: they are heavy, or there is a funnel, and "
      "tau is the parameter known worst; infer it on a logarithmic scale or give it a prior that bounds it");
  EXPECT_EQ(sentence({.state = ChainState::rare_tails}),
            "tau visits its tails too seldom (R-hat 1.0312, effective sample sizes 150 in the bulk and 90 in the tails): long tails or a funnel towards one "
            "end; look at its pairs in the report, and infer it on a logarithmic scale or bound it where values are impossible");
  EXPECT_EQ(sentence({.state = ChainState::start_remembered, .suggested_draws = 400}),
            "tau differs a little between chains (R-hat 1.0312, effective sample sizes 150 in the bulk and 90 in the tails), each of which has draws enough: "
            "they have not forgotten where they began; double sampler.warmup and set sampler.draws = 400");
  EXPECT_EQ(sentence({.state = ChainState::few_draws, .needed_draws = 1803, .suggested_draws = 2000, .thin = 4}),
            "tau has too few independent draws (R-hat 1.0312, effective sample sizes 150 in the bulk and 90 in the tails); at this rate 1803 draws a chain are "
            "enough: set sampler.draws = 2000 (sampler.thin = 4)");
  EXPECT_EQ(sentence({.state = ChainState::slow_mixing, .suggested_draws = 5000, .draws_per_independent = 34}),
            "tau differs between chains that overlap (R-hat 1.0312, effective sample sizes 150 in the bulk and 90 in the tails): they mix too slowly for their "
            "length, one draw in 34 being independent; double sampler.warmup, so that the proposal fits, and set sampler.draws = 5000");
}

TEST(ConvergenceWords, ManyChainsAreNotAllListedAndWalkersAreCalledSo) {
  const auto apart = sentence({.state = ChainState::separate_modes, .chains = {0, 2, 4, 6, 8, 10, 12, 14, 16}, .others = {1}});
  EXPECT_NE(apart.find("in chains 1, 3, 5 and 6 more and near 0 in chain 2,"), std::string::npos) << apart;
  const auto walkers = sentence({.state = ChainState::start_remembered, .walkers = true});
  EXPECT_NE(walkers.find("between walkers"), std::string::npos) << walkers;
}

TEST(ConvergenceWords, DivergencesOfConvergedChainsFollowTheSentence) {
  EXPECT_EQ(sentence({.state = ChainState::converged, .transitions = 4000, .remedies = walk}, 3),
            "converged: tau is the least well known, with R-hat 1.0312, effective sample sizes 150 in the bulk and 90 in the tails; 3 of 4000 trajectories "
            "diverged: draws may be missing where the density bends sharply, raise sampler.walk.accuracy to 0.95 to see");
}
