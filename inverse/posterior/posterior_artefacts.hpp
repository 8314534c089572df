#pragma once
/// What the artefacts report of a fit of the posterior and of its check by the true model.
#include "inverse/posterior/fit_residual.hpp"
#include "inverse/posterior/posterior_fit.hpp"
#include "inverse/posterior/true_model_check.hpp"

namespace calomel {

/// Mode, covariance, evidence, rounds, levels and shares of the errors' covariance; theta by name. message: whether the emulator has settled,
/// for people.
Json fit_json(const PosteriorFit& fit, const std::vector<Parameter>& parameters, const std::string& message);
/// [{term, gauge, pull, sd}], the largest deviation first; `pull` is the key of the deviation.
Json prior_deviations_json(const FitResidual& left);
/// {term: share of the covariance's trace}.
Json shares_json(const ErrorModel& errors);
/// {holds, score, score_sd, p_value, log_likelihood_shift, sentence, runs: [{theta, level, done, distance, score}]}. sentence: for people.
Json check_json(const TrueModelCheck& check, const std::vector<Parameter>& parameters, const std::string& sentence);

}  // namespace calomel
