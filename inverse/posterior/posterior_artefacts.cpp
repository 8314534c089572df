#include "inverse/posterior/posterior_artefacts.hpp"

#include <cmath>

#include "base/json.hpp"
#include "inverse/posterior/prior_deviations.hpp"

namespace calomel {

Json fit_json(const PosteriorFit& fit, const std::vector<Parameter>& parameters, const std::string& message) {
  const auto& best = fit.modes[0];
  const auto density = fit.posterior->density(best.at);
  const Eigen::MatrixXd covariance = parameter_covariance(*fit.posterior, best);
  const Eigen::VectorXd sd = covariance.diagonal().cwiseSqrt();
  Json rounds = Json::array(), levels = Json::array(), others = Json::array(), discrepancy = Json::array();
  for (const auto& r : fit.rounds)
    rounds.push_back({{"coarse_runs", r.coarse},
                      {"fine_runs", r.fine},
                      {"failed", r.failed},
                      {"theta", named(parameters, r.theta)},
                      {"moved_sds", number(r.moved)},
                      {"emulator_variance", number(r.variance)},
                      {"box_moved", r.moved_box}});
  for (const auto& l : fit.levels) levels.push_back({{"runs", l.runs}, {"left_out", number(l.left_out)}, {"noise", number(l.noise)}});
  for (std::size_t i = 1; i < fit.modes.size(); ++i)
    others.push_back({{"theta", named(parameters, fit.modes[i].at.theta)}, {"log_posterior", number(fit.modes[i].log_posterior)}});
  if (fit.hypotheses.size() > 1)
    for (std::size_t j = 0; j < fit.hypotheses.size(); ++j)
      discrepancy.push_back({{"scale", fit.hypotheses[j].discrepancy}, {"weight", number(density.weights[j])}});
  const auto& prior = fit.posterior->beyond_prior();
  return {{"theta", named(parameters, best.at.theta)},
          {"sd", named(parameters, {sd.data(), std::size_t(sd.size())})},
          {"covariance", matrix_json(covariance)},
          {"beyond", best.at.beyond},
          {"beyond_pull", fit.posterior->has_beyond() ? number((best.at.beyond - prior.mean) / prior.sd) : Json()},
          {"log_likelihood", number(density.log_likelihood)},
          {"log_prior", number(density.log_prior)},
          {"log_evidence_laplace", number(log_evidence(*fit.posterior, best))},
          {"chi2", number(density.chi2)},
          {"values", fit.posterior->values()},
          {"emulator_variance", number(density.variance)},
          {"gradient", number(best.gradient)},
          {"discrepancy", discrepancy},
          {"other_modes", others},
          {"settled", fit.settled},
          {"message", message},
          {"rounds", rounds},
          {"levels", levels},
          {"covariance_shares", shares_json(*fit.errors)},
          {"pulls", prior_deviations_json(residual_of(fit))}};
}

Json prior_deviations_json(const FitResidual& left) {
  Json all = Json::array();
  for (const auto& p : prior_deviations(left)) all.push_back({{"term", p.term}, {"gauge", p.gauge}, {"pull", number(p.deviation)}, {"sd", number(p.sd)}});
  return all;
}

Json shares_json(const ErrorModel& errors) {
  Json all = Json::object();
  for (const auto& [name, share] : errors.shares()) all[name] = number(share);
  return all;
}

Json check_json(const TrueModelCheck& check, const std::vector<Parameter>& parameters, const std::string& sentence) {
  Json runs = Json::array();
  for (const auto& r : check.runs)
    runs.push_back({{"theta", named(parameters, r.theta)}, {"level", r.level}, {"done", r.done}, {"distance", number(r.distance)}, {"score", number(r.score)}});
  return {{"holds", check.holds},
          {"score", number(check.score)},
          {"score_sd", number(check.score_sd)},
          {"p_value", number(check.p_value)},
          {"log_likelihood_shift", number(check.log_likelihood_shift)},
          {"sentence", sentence},
          {"runs", runs}};
}

}  // namespace calomel
