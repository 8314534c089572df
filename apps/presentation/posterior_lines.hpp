#pragma once
/// Sentences about the posterior: the emulator's rounds, the chains, the check by the true model.
#include <string>
#include <vector>

#include "inverse/posterior/posterior_fit.hpp"
#include "inverse/posterior/true_model_check.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/drawn_noise_density.hpp"
#include "uq/refinement.hpp"
#include "uq/sampler/modes.hpp"
#include "uq/sampler/sampler_options.hpp"

namespace calomel {

/// After a round of the emulator: its runs, the mode with its deviations, the emulator's variance.
std::string round_line(const PosteriorRound& round, const std::vector<Parameter>& parameters);

/// Mean, deviation, interval and convergence, a line a parameter.
std::vector<std::string> draws_lines(const Convergence& convergence);
/// Whether the emulator of a fit has settled.
std::string emulator_sentence(const PosteriorFit& fit);
/// What the set-up of a posterior found, a sentence each.
std::vector<std::string> setup_sentences(const SetupFindings& findings);

/// The warning that standard deviations are too small on a mesh with so few elements through the front of the pulse.
std::string front_sentence(double elements_per_front, double finest_size);
/// The sentence for a parameter whose posterior mean is `prior_sds` prior standard deviations above (negative: below) its prior mean.
std::string absorption_sentence(const std::string& parameter, double prior_sds);

/// How many modes a density has, where they lie and their shares.
std::string modes_sentence(const LogDensity& density, const std::vector<LaplaceMode>& modes);

/// The number of effective draws of the noise's hyperparameters, and the largest inflation of a standard deviation with its quantity.
std::string inflation_sentence(const NoiseInflation& inflation, const std::vector<std::string>& names);
/// The errors of a form of `[posterior] compare`. Errors: ContractFailure for an unknown name.
std::string form_sentence(const std::string& form);
/// Why the emulator's hyperparameters were held at their estimate: the sampler corrects the emulator by the true model, or the case has no draws of them.
std::string estimate_only_reason(const SamplerOptions& sampler);
/// How often the emulator was refined, and why it ended.
std::string refinement_sentence(const RefinedFit& fit);

/// Why the posterior is to be trusted or not, the gravest reason first.
std::string verdict_sentence(const Convergence& convergence, const PosteriorFit& fit, const TrueModelCheck& check);

}  // namespace calomel
