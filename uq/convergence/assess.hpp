#pragma once
/// Whether a posterior's draws have converged, and if not, the likely cause as data. The sentence for people is apps/presentation/convergence_words.hpp.
#include <optional>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "uq/draws.hpp"

namespace calomel {

/// Draws have converged when R-hat < r_hat and the bulk and tail effective sample sizes are >= ess for every parameter (Vehtari et al. 2021, section 4: 1.01,
/// and 100 a chain of four chains), and when E-BFMI >= e_bfmi in every chain that has one (Betancourt 2016; Stan's limit).
struct ConvergenceLimits {
  double r_hat = 1.01;
  double ess = 400;
  double e_bfmi = 0.3;
};

/// The summary of one parameter.
struct ParameterSummary {
  std::string name;
  double mean = 0, sd = 0, q05 = 0, q50 = 0, q95 = 0;  ///< over all draws [unit of the parameter]
  double r_hat = 0, ess_bulk = 0, ess_tail = 0;        ///< NaN where they are undefined for these draws
  double mcse_mean = 0, mcse_sd = 0, mcse_q05 = 0, mcse_q50 = 0, mcse_q95 = 0;
};

/// Keys of a sampler that the user may change when its chains have not converged. Each is a whole key, as "sampler.NAME.target"; it is empty where the sampler
/// has no such key.
struct SamplerRemedies {
  std::string accuracy_key;     ///< accuracy of the steps along a trajectory
  double safer_accuracy = 0;    ///< a value of it with which fewer trajectories diverge
  std::string length_key;       ///< greatest length of a trajectory
  std::string correlation_key;  ///< correlation below which particles of a population count as independent of their ancestors
  std::string emulator_only;    ///< for a sampler that corrects an emulator by the true model: the sampler of the emulator alone
};

/// Facts about a run that its draws do not show; they sharpen the cause that is found.
struct SamplingFacts {
  std::optional<double> acceptance;  ///< mean acceptance of the kept transitions, [0, 1]
  int thin = 1;                      ///< transitions for each kept draw
  std::vector<double> e_bfmi;        ///< (chain), see EnergyChanges; empty where the sampler has no momenta
  std::size_t divergences = 0;       ///< kept transitions whose trajectory diverged
  std::size_t cut = 0;               ///< kept transitions whose trajectory the greatest number of doublings ended
  std::size_t transitions = 0;       ///< kept transitions
  SamplerRemedies remedies;          ///< the sampler's own
};

/// The state of the chains: converged, or the likely cause that they have not, in the order in which causes are tried.
enum class ChainState {
  not_assessed,
  converged,
  short_chains,        ///< fewer than four draws in a chain
  not_finite,          ///< some draws are not finite
  constant,            ///< all draws are equal
  still_chains,        ///< some chains did not move
  drift,               ///< most chains still move one way
  separate_modes,      ///< chains remain on either side of a gap
  divergences,         ///< many trajectories diverged
  cut_trajectories,    ///< many trajectories were ended before they turned
  common_ancestors,    ///< particles of a population share ancestors
  emulator_disagrees,  ///< the true model refuses most proposals of the emulator
  refused_proposals,   ///< hardly any transition moves
  ridge,               ///< a narrow ridge between two parameters
  slow_energies,       ///< energies change too slowly between transitions
  rare_tails,          ///< the bulk mixes, the tails are visited seldom
  start_remembered,    ///< each chain has enough draws, and they differ by their starts
  few_draws,           ///< too few independent draws
  slow_mixing          ///< chains overlap and mix slowly
};

/// The state with its numbers. Which of them are set is stated with each.
struct ConvergenceFinding {
  ChainState state = ChainState::not_assessed;
  std::size_t draws = 0;             ///< draws of a chain; always set
  bool walkers = false;              ///< whether chains are walkers that move together; always set
  std::vector<std::size_t> chains;   ///< still_chains, slow_energies: the chains concerned; separate_modes: those of the lower group. Counted from 0
  std::vector<std::size_t> others;   ///< separate_modes: the chains of the higher group
  double low_at = 0;                 ///< separate_modes: mean of the lower group
  double high_at = 0;                ///< separate_modes: mean of the higher group
  double value = 0;                  ///< constant: the value of all draws
  double share = 0;                  ///< cut_trajectories: share of the trajectories; emulator_disagrees, refused_proposals: mean acceptance
  std::string partner;               ///< ridge: the other parameter
  double correlation = 0;            ///< ridge: correlation of the two
  double e_bfmi = 0;                 ///< slow_energies: E-BFMI of the first chain concerned
  double needed_draws = 0;           ///< few_draws: draws of a chain that suffice at this rate
  double suggested_draws = 0;        ///< common_ancestors, start_remembered, few_draws, slow_mixing: a rounded number of draws of a chain
  double draws_per_independent = 0;  ///< slow_mixing: draws for each independent one
  int thin = 1;                      ///< few_draws: transitions for each kept draw
  std::size_t transitions = 0;       ///< kept transitions of all chains, as in the facts; always set
  SamplerRemedies remedies;          ///< as in the facts; always set
};

/// The assessment of a run's draws.
struct Convergence {
  bool converged = false;
  ConvergenceFinding finding;
  std::string parameter;                     ///< the parameter that is known worst
  std::vector<ParameterSummary> parameters;  ///< in the order of the draws
  std::vector<double> e_bfmi;                ///< as in the facts
  std::size_t divergences = 0;               ///< as in the facts
};

/// Summarises all parameters and decides whether the draws have converged; if not, finds the likely cause for the worst parameter.
Convergence assess(const Draws& draws, const SamplingFacts& facts = {}, const ConvergenceLimits& limits = {});

/// {parameters: [{name, mean, sd, q05, q50, q95, r_hat, ess_bulk, ess_tail, mcse_mean, mcse_sd, mcse_q05, mcse_q50, mcse_q95}], converged, message}, and
/// {e_bfmi: [chain], divergences} where the sampler has momenta; null for what is NaN or infinite. message: a sentence about the state, for people.
Json convergence_json(const Convergence& convergence, const std::string& message);

}  // namespace calomel
