#pragma once
/// Whether a posterior's draws are to be trusted, and if not, what is wrong in one sentence.
#include <optional>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "uq/draws.hpp"

namespace calomel {

/// Converged is: R-hat < r_hat and bulk and tail effective sample size >= ess for every parameter (Vehtari et al. 2021, section 4: 1.01, and 100 a chain of
/// four chains), and E-BFMI >= e_bfmi in every chain that has one (Betancourt 2016; Stan's limit).
struct ConvergenceLimits {
  double r_hat = 1.01;
  double ess = 400;
  double e_bfmi = 0.3;
};

struct ParameterSummary {
  std::string name;
  double mean = 0, sd = 0, q05 = 0, q50 = 0, q95 = 0;  ///< over all draws [unit of the parameter]
  double r_hat = 0, ess_bulk = 0, ess_tail = 0;        ///< NaN where the draws give no answer
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

/// What the run knows beside its draws; it sharpens the cause that is named.
struct SamplingFacts {
  std::optional<double> acceptance;  ///< mean acceptance of the kept transitions, [0, 1]
  int thin = 1;                      ///< transitions a kept draw
  std::vector<double> e_bfmi;        ///< (chain), see EnergyChanges; empty where the sampler has no momenta
  std::size_t divergences = 0;       ///< of the kept transitions: trajectories given up
  std::size_t cut = 0;               ///< of the kept transitions: trajectories that the greatest number of doublings ended
  std::size_t transitions = 0;       ///< kept
  SamplerRemedies remedies;          ///< the sampler's own
};

struct Convergence {
  bool converged = false;
  std::string message = "not assessed";      ///< one sentence
  std::string parameter;                     ///< the worst one
  std::vector<ParameterSummary> parameters;  ///< in the order of the draws
  std::vector<double> e_bfmi;                ///< as in the facts
  std::size_t divergences = 0;               ///< as in the facts
};

/// Summaries of all parameters and the verdict. Not converged: the message names the worst parameter, the likely cause, in this order of suspicion:
/// draws that are not finite or do not move; chains that still drift; chains in different modes; trajectories that diverge, or that end too early; hardly any
/// proposal accepted; a narrow ridge between two parameters; energies that change too slowly; rare visits to the tails; too few draws; and what to do about it.
/// Divergences of a converged run are told behind the sentence.
Convergence assess(const Draws& draws, const SamplingFacts& facts = {}, const ConvergenceLimits& limits = {});

/// {parameters: [{name, mean, sd, q05, q50, q95, r_hat, ess_bulk, ess_tail, mcse_mean, mcse_sd, mcse_q05, mcse_q50, mcse_q95}], converged, message}, and
/// {e_bfmi: [chain], divergences} where the sampler has momenta; null for what is NaN or infinite.
Json convergence_json(const Convergence& convergence);

}  // namespace calomel
