#include "apps/presentation/convergence_words.hpp"

#include <fmt/format.h>

namespace calomel {

namespace {

/// The summary of the parameter that is known worst; without it, an empty one of that name.
ParameterSummary worst_of(const Convergence& convergence) {
  for (const auto& s : convergence.parameters)
    if (s.name == convergence.parameter) return s;
  return {.name = convergence.parameter};
}

std::string numbers(const ParameterSummary& s) {
  return fmt::format("R-hat {:.4f}, effective sample sizes {:.0f} in the bulk and {:.0f} in the tails", s.r_hat, s.ess_bulk, s.ess_tail);
}

/// "chains 1, 3 and 4", counted from 1. Of many chains, which walkers come in, only the first three are listed.
std::string chain_list(const std::vector<std::size_t>& chains) {
  constexpr std::size_t most_listed = 8;
  constexpr std::size_t first = 3;
  std::string s;
  if (chains.size() > most_listed)
    s = fmt::format("{}, {}, {} and {} more", chains[0] + 1, chains[1] + 1, chains[2] + 1, chains.size() - first);
  else
    for (std::size_t i = 0; i < chains.size(); ++i) s += (i == 0 ? "" : i + 1 == chains.size() ? " and " : ", ") + std::to_string(chains[i] + 1);
  return (chains.size() > 1 ? "chains " : "chain ") + s;
}

/// "raise KEY to VALUE" against trajectories that diverge; empty where the sampler has no such key.
std::string more_accuracy(const SamplerRemedies& remedies) {
  return remedies.accuracy_key.empty() ? "" : fmt::format("raise {} to {}", remedies.accuracy_key, remedies.safer_accuracy);
}

std::string sentence_of(const Convergence& convergence) {
  const ConvergenceFinding& f = convergence.finding;
  const ParameterSummary s = worst_of(convergence);
  const std::string& name = s.name;
  switch (f.state) {
    case ChainState::not_assessed:
      return "not assessed";
    case ChainState::converged:
      return fmt::format("converged: {} is the least well known, with {}", name, numbers(s));
    case ChainState::short_chains:
      return fmt::format("{} cannot be judged by {} draws a chain; set sampler.draws to some thousands", name, f.draws);
    case ChainState::not_finite:
      return fmt::format(
          "{} has draws that are not finite, so the density or its transformation is wrong there; look at them in posterior.nc and narrow the bounds of {}",
          name, name);
    case ChainState::constant:
      return fmt::format(
          "{} has not moved: all draws are {:g}, because every proposal was refused; start from the covariance of calibrate --method map, or raise "
          "sampler.warmup",
          name, f.value);
    case ChainState::still_chains:
      return fmt::format(
          "{} has not moved in {} (R-hat {:.3f}), while other chains did; those started where proposals are refused, so lower sampler.dispersion or raise "
          "sampler.warmup",
          name, chain_list(f.chains), s.r_hat);
    case ChainState::drift:
      return fmt::format(
          "{} still drifts in one direction in most chains ({}), so the warm-up ended before they had arrived; double sampler.warmup, or start from the mode "
          "and covariance of calibrate --method map",
          name, numbers(s));
    case ChainState::separate_modes:
      return fmt::format(
          "{} lies near {:.5g} in {} and near {:.5g} in {}, and no chain goes from one to the other (R-hat {:.2f}): two modes, whose weights these draws do "
          "not determine; compare the modes (calibrate --method map lists other optima) and narrow the bounds or the prior of {} to the one that is meant",
          name, f.low_at, chain_list(f.chains), f.high_at, chain_list(f.others), s.r_hat, name);
    case ChainState::divergences:
      return fmt::format(
          "{} is not known ({}) and {} of {} trajectories diverged: the density bends more sharply somewhere than their steps can follow, as in a funnel, or "
          "ends at an edge; {}infer {} on a logarithmic scale",
          name, numbers(s), convergence.divergences, f.transitions, f.remedies.accuracy_key.empty() ? "" : more_accuracy(f.remedies) + ", or ", name);
    case ChainState::cut_trajectories:
      return fmt::format(
          "{} mixes slowly ({}) because {:.0f} % of the trajectories are ended by {} before they turn: scales differ more than the metric corrects; double "
          "sampler.warmup, so that it is learnt, or raise {}",
          name, numbers(s), 100 * f.share, f.remedies.length_key, f.remedies.length_key);
    case ChainState::common_ancestors:
      return fmt::format(
          "{} differs between populations of particles ({}), which still have ancestors in common where they arrive; halve {}, so that they move more, "
          "and set sampler.draws = {:.0f}",
          name, numbers(s), f.remedies.correlation_key, f.suggested_draws);
    case ChainState::emulator_disagrees:
      return fmt::format(
          "{} mixes slowly ({}) because the true model refuses {:.0f} % of what the emulator proposes: the two disagree there, or runs carry much numerical "
          "noise; give the emulator more runs (emulator.rounds), or take sampler.kind = \"{}\", whose check by the true model shows by how much they differ",
          name, numbers(s), 100 * (1 - f.share), f.remedies.emulator_only);
    case ChainState::refused_proposals:
      return fmt::format(
          "{} mixes slowly ({}) because only {:.1f} % of the transitions move: the frozen proposal does not fit the density; raise sampler.warmup, or start "
          "from the covariance of calibrate --method map",
          name, numbers(s), 100 * f.share);
    case ChainState::ridge:
      return fmt::format(
          "{} mixes slowly ({}) along the narrow ridge that it forms with {} (correlation {:.3f}); give one of the two a prior from elsewhere, or let the "
          "proposal learn the ridge: start from the covariance of calibrate --method map and double sampler.warmup",
          name, numbers(s), f.partner, f.correlation);
    case ChainState::slow_energies:
      return fmt::format(
          "the energy changes too slowly in {} (E-BFMI {:.2f}), so that the tails are explored by diffusion alone: they are heavy, or there is a funnel, and "
          "{} is "
          "the parameter known worst; infer it on a logarithmic scale or give it a prior that bounds it",
          chain_list(f.chains), f.e_bfmi, name);
    case ChainState::rare_tails:
      return fmt::format(
          "{} visits its tails too seldom ({}): long tails or a funnel towards one end; look at its pairs in the report, and infer it on a logarithmic scale "
          "or "
          "bound it where values are impossible",
          name, numbers(s));
    case ChainState::start_remembered:
      return fmt::format(
          "{} differs a little between {} ({}), each of which has draws enough: they have not forgotten where they began; double sampler.warmup and set "
          "sampler.draws = {:.0f}",
          name, f.walkers ? "walkers" : "chains", numbers(s), f.suggested_draws);
    case ChainState::few_draws:
      return fmt::format("{} has too few independent draws ({}); at this rate {:.0f} draws a chain are enough: set sampler.draws = {:.0f}{}", name, numbers(s),
                         f.needed_draws, f.suggested_draws, f.thin > 1 ? fmt::format(" (sampler.thin = {})", f.thin) : "");
    case ChainState::slow_mixing:
      return fmt::format(
          "{} differs between chains that overlap ({}): they mix too slowly for their length, one draw in {:.0f} being independent; double sampler.warmup, so "
          "that the proposal fits, and set sampler.draws = {:.0f}",
          name, numbers(s), f.draws_per_independent, f.suggested_draws);
  }
  return "";
}

}  // namespace

std::string convergence_sentence(const Convergence& convergence) {
  const ConvergenceFinding& f = convergence.finding;
  std::string s = sentence_of(convergence);
  if (convergence.converged && convergence.divergences > 0)
    s += fmt::format("; {} of {} trajectories diverged: draws may be missing where the density bends sharply{}", convergence.divergences, f.transitions,
                     f.remedies.accuracy_key.empty() ? "" : fmt::format(", {} to see", more_accuracy(f.remedies)));
  return s;
}

}  // namespace calomel
