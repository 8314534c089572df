#include "inverse/map_judgement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>

#include "base/nan.hpp"

namespace calomel {

namespace {

constexpr double least_p_value = 0.01;
constexpr double told_apart = 0.8;  ///< chi-squared over its expectation below which the covariance is called too wide

/// The share of replicated data that would fit worse: chi-squared, or F for the multivariate t.
double tail(double chi2, double freedom, double of_scale) {
  if (!(freedom > 0)) return nan;
  if (std::isinf(of_scale)) return boost::math::cdf(boost::math::complement(boost::math::chi_squared(freedom), chi2));
  return boost::math::cdf(boost::math::complement(boost::math::fisher_f(freedom, of_scale), chi2 / freedom));
}

/// The chi-squared at which tail() comes to least_p_value.
double critical(double freedom, double of_scale) {
  if (std::isinf(of_scale)) return boost::math::quantile(boost::math::complement(boost::math::chi_squared(freedom), least_p_value));
  return freedom * boost::math::quantile(boost::math::complement(boost::math::fisher_f(freedom, of_scale), least_p_value));
}

/// Spread of rival optima about x, each weighed by exp(-(drop of its log posterior) / temperature), (n, n).
Eigen::MatrixXd spread_of(const std::vector<std::pair<Eigen::VectorXd, double>>& rivals, const Eigen::VectorXd& x, double log_posterior, double temperature) {
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(x.size(), x.size());
  double total = 1;  // of the mode itself
  for (const auto& [at, value] : rivals) {
    const Eigen::VectorXd d = at - x;
    if (d.cwiseAbs().maxCoeff() == 0) continue;
    const double weight = std::exp(std::min(0.0, value - log_posterior) / temperature);
    spread += weight * d * d.transpose(), total += weight;
  }
  return spread / total;
}

}  // namespace

void judge_fit(MapSummary& out, const Likelihood& likelihood, const Eigen::VectorXd& residual, std::size_t parameters, bool widen) {
  const auto& errors = likelihood.errors();
  out.values = std::size_t(errors.size());
  out.chi2 = errors.chi2(residual);
  out.effective_data = errors.effective_data(), out.effective_chi2 = errors.effective_chi2(residual);
  const double freedom = double(out.values) - double(parameters), effective = std::max(1.0, out.effective_data - double(parameters));
  out.p_value = tail(out.chi2, freedom, errors.freedom());
  out.effective_p_value = tail(out.effective_chi2, effective, errors.freedom());
  out.adequate = out.p_value >= least_p_value && out.effective_p_value >= least_p_value;
  if (widen && !out.adequate) out.widening = std::max({1.0, out.chi2 / std::max(1.0, freedom), out.effective_chi2 / effective});
  const std::string numbers = fmt::format("chi-squared {:.4g} for {} values less {} parameters (p {:.2g}), {:.3g} for {:.3g} effective data (p {:.2g})", out.chi2, out.values,
                                          parameters, out.p_value, out.effective_chi2, out.effective_data, out.effective_p_value);
  out.adequacy = out.adequate ? "the records do not contradict the fit: " + numbers : "the fit is not adequate: the model leaves out more than noise and known errors explain: " + numbers;
  if (out.adequate && freedom > 0) {
    out.chi2_critical = critical(freedom, errors.freedom());
    if (out.chi2 < told_apart * freedom)
      out.adequacy += fmt::format("; the errors taken for granted are {:.2g} times as wide as the residuals, and chi-squared would have spoken only above {:.4g}: it has not seen what adds less than {:.3g} to it",
                                  std::sqrt(freedom / out.chi2), out.chi2_critical, out.chi2_critical - out.chi2);
  }
  if (out.widening > 1) out.adequacy += fmt::format("; standard deviations are widened by {:.3g}", std::sqrt(out.widening));
}

void take_screening(MapSummary& out, Screening screening) {
  if (screening.stands_out) {
    out.adequacy = (out.adequate ? "the fit is not adequate: " : out.adequacy + "; ") + screening.sentence;
    out.adequate = false;
  }
  out.screening = std::move(screening);
}

double exact_slope(const ForwardModel& surrogate, const Likelihood& likelihood, const SearchSpace& space, const Optimum& o) {
  if (!surrogate.has_gradient()) return nan;
  const auto theta = space.theta(o.x);
  const Prediction p = surrogate.evaluate(theta);
  if (!p.ok) return nan;
  const Eigen::VectorXd weights = likelihood.gradient(theta, p.mean);
  const Eigen::VectorXd by_theta = surrogate.pull_back(theta, {weights.data(), std::size_t(weights.size())});
  Eigen::VectorXd by_x = by_theta.cwiseProduct(space.slope(o.x)) - space.prior_jacobian(o.x).transpose() * space.prior_residuals(o.x);
  for (Eigen::Index k = 0; k < by_x.size(); ++k)  // at a bound the density may go on rising outwards
    if ((o.x[k] >= space.high()[k] - 1e-9 && by_x[k] > 0) || (o.x[k] <= space.low()[k] + 1e-9 && by_x[k] < 0)) by_x[k] = 0;
  return by_x.cwiseProduct(o.covariance.diagonal().cwiseSqrt()).cwiseAbs().maxCoeff();
}

Eigen::MatrixXd spread_of_rivals(MapSummary& out, const SearchSpace& space, const Eigen::VectorXd& x, double log_posterior) {
  std::vector<std::pair<Eigen::VectorXd, double>> rivals;
  double apart = 0, disagreement = 0;
  for (const auto& c : out.candidates)
    if (c.objective_model && std::isfinite(c.objective_surrogate)) rivals.emplace_back(space.from(c.theta), *c.objective_model), apart += c.objective_surrogate - *c.objective_model;
  for (const auto& c : out.candidates)
    if (c.objective_model && std::isfinite(c.objective_surrogate))
      disagreement += std::pow(c.objective_surrogate - *c.objective_model - apart / double(rivals.size()), 2);
  if (rivals.size() > 1) out.roughness = std::sqrt(disagreement / double(rivals.size() - 1));
  return spread_of(rivals, x, log_posterior, std::max(1.0, out.roughness));
}

Eigen::MatrixXd spread_of_rounds(const MapRefinement& refinement, const SearchSpace& space, const Eigen::VectorXd& x) {
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(x.size(), x.size());
  if (refinement.rounds.size() < 3) return spread;
  for (std::size_t i = 1; i < refinement.rounds.size(); ++i) {  // the first moves the optimum from where nothing was known of the mesh
    const Eigen::VectorXd d = space.from(refinement.rounds[i].theta) - x;
    spread += d * d.transpose();
  }
  return spread / double(refinement.rounds.size() - 1);
}

void warn(MapSummary& out, const SearchSpace& space, const Eigen::VectorXd& x, const Eigen::MatrixXd& covariance, bool limited) {
  if (!out.adequate) out.warnings.push_back(out.adequacy);
  for (Eigen::Index k = 0; k < space.size(); ++k) {
    const double sd = std::sqrt(covariance(k, k));
    const double room = std::min(x[k] - space.low()[k], space.high()[k] - x[k]);
    if (room > 1e-3 * (space.high()[k] - space.low()[k]) && room < 2 * sd)
      out.warnings.push_back(fmt::format("a bound of {} lies within two standard deviations: its interval and the evidence are those of a density that reaches beyond",
                                         space.parameters()[std::size_t(k)].name));
  }
  if (limited) out.warnings.push_back("the data leave a combination of parameters free; its interval is limited by the bounds");
  if (out.split_half > 2)
    out.warnings.push_back(fmt::format("early and late pulses differ {:.2g} times more than independent pulses would: the records drift", out.split_half));
}

}  // namespace calomel
