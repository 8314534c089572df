#include "inverse/map/map.hpp"

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.hpp"
#include "base/not_finite.hpp"

namespace calomel {

namespace {

constexpr std::size_t most_candidates = 4;  ///< modes that are run in the true model

/// The finest mesh at the modes and at the nominal point.
void run_candidates(MapSummary& out, const PosteriorInputs& in, const PosteriorFit& fit) {
  const LogPosterior& posterior = *fit.posterior;
  const Clock clock;
  const auto n = in.problem.shape.parameters.size();
  std::vector<LogPosterior::Point> points;
  for (std::size_t i = 0; i < std::min(fit.modes.size(), most_candidates); ++i) points.push_back(fit.modes[i].at);
  LogPosterior::Point at_nominal{.u = {}, .beyond = fit.modes[0].at.beyond, .theta = out.nominal};
  for (std::size_t k = n; k < in.parameters.size(); ++k) at_nominal.theta.push_back(*in.parameters[k].nominal);
  at_nominal.u = posterior.box().u(at_nominal.theta);
  points.push_back(at_nominal);
  Eigen::MatrixXd thetas(posterior.box().size(), Eigen::Index(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) thetas.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXd>(points[i].theta.data(), thetas.rows());
  const auto records = in.run(thetas, std::vector<int>(points.size(), 0));

  std::vector<std::vector<double>> histories(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool is_nominal = i + 1 == points.size();
    const auto& p = points[i];
    Candidate c{.theta = {p.theta.begin(), p.theta.begin() + std::ptrdiff_t(n)}};
    const auto density = posterior.density(p);
    c.objective_surrogate = is_nominal && !posterior.box().contains(p.theta) ? nan : density.log_posterior();
    if (records[i].done) {
      histories[i].assign(records[i].mean.begin(), records[i].mean.end());
      c.score = score(in.problem, histories[i]);
      const Eigen::VectorXd run = fit.errors->grid().apply(Eigen::Map<const Eigen::VectorXd>(histories[i].data(), Eigen::Index(histories[i].size())));
      const double value = posterior.log_likelihood_of(run, 1) + density.log_prior;
      if (std::isfinite(value)) c.objective_model = value;
    }
    c.message = records[i].message;
    if (is_nominal) {
      out.at_nominal = std::move(c);
      out.nominal_values = std::move(histories[i]);
    } else {
      (c.objective_model ? out.candidates : out.failed).push_back(std::move(c));
    }
  }
  out.model_runs = points.size();
  out.model_s = clock.seconds();
  out.theta.assign(points[0].theta.begin(), points[0].theta.begin() + std::ptrdiff_t(n));
  if (out.candidates.empty() || out.candidates[0].theta != out.theta) {  // the answer is the mode all the same; nothing has verified it
    out.best = out.failed[0];
    out.status = CalibrationStatus::no_candidate;
    return;
  }
  out.best = out.candidates[0];
  out.calibrated = histories[0];
  out.status = fit.settled ? CalibrationStatus::done : CalibrationStatus::not_settled;
}

std::vector<Nuisance> nuisances_of(const PosteriorInputs& in, const PosteriorFit& fit) {
  const LocalMode& m = fit.modes[0];
  const Eigen::MatrixXd covariance = parameter_covariance(*fit.posterior, m);
  std::vector<Nuisance> out;
  for (std::size_t k = in.problem.shape.parameters.size(); k < in.parameters.size(); ++k) {
    const Parameter& p = in.parameters[k];
    Nuisance x{.name = p.name, .value = m.at.theta[k], .sd = std::sqrt(covariance(Eigen::Index(k), Eigen::Index(k)))};
    if (p.prior == "lognormal") {
      x.prior_value = std::exp(*p.mu);
      x.prior_sd = *p.sigma * x.prior_value;
    }
    if (p.prior == "normal") {
      x.prior_value = *p.mean;
      x.prior_sd = *p.sd;
    }
    x.deviation = prior_deviation(p, x.value).value_or(0);
    out.push_back(std::move(x));
  }
  if (fit.posterior->has_beyond()) {
    const auto& prior = fit.posterior->beyond_prior();
    const Eigen::Index last = m.covariance.rows() - 1;
    out.push_back({"beyond", m.at.beyond, std::sqrt(m.covariance(last, last)), prior.mean, prior.sd, (m.at.beyond - prior.mean) / prior.sd});
  }
  return out;
}

/// What the data pin: the precision of the posterior, nuisances marginalised, less that of the prior.
Identification identification_of(const PosteriorInputs& in, const PosteriorFit& fit, const Eigen::MatrixXd& covariance) {
  const auto& parameters = in.problem.shape.parameters;
  const auto n = Eigen::Index(parameters.size());
  const auto& theta = fit.modes[0].at.theta;
  Eigen::MatrixXd data = inverse_symmetric(covariance);
  Eigen::VectorXd prior_sd(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Prior& prior = fit.posterior->priors()[std::size_t(k)];
    const Parameter& p = in.parameters[std::size_t(k)];
    prior_sd[k] = p.prior == "lognormal" ? *p.sigma * theta[std::size_t(k)] : prior.scale();  // of the logarithm, which the covariance is of
    if (prior.kind() != "uniform") data(k, k) -= 1 / std::pow(prior_sd[k], 2);
  }
  return identify(parameters, {theta.begin(), theta.begin() + n}, data, covariance, prior_sd, in.identified, in.combinations);
}

}  // namespace

MapSummary run_map(const PosteriorInputs& in, const PosteriorFit& fit, const std::string& product,
                   const std::function<std::vector<MechanismDirections>(std::span<const double>)>& left_out, const NestedModel* nested) {
  const LogPosterior& posterior = *fit.posterior;
  const LocalMode& mode = fit.modes[0];
  MapSummary out;
  out.objective = {"log_posterior", true, {}};
  out.product = product;
  out.nominal = nominal(in.problem.shape);
  out.warnings = in.problem.warnings;
  out.warnings.insert(out.warnings.end(), in.warnings.begin(), in.warnings.end());
  out.mesh.scores_on = in.levels > 1 ? ScoredMesh::emulators_finest : ScoredMesh::own;
  run_candidates(out, in, fit);

  const auto n = Eigen::Index(in.problem.shape.parameters.size());
  const auto density = posterior.density(mode.at);
  out.covariance = parameter_covariance(posterior, mode).topLeftCorner(n, n);
  out.nuisances = nuisances_of(in, fit);
  out.log_likelihood = density.log_likelihood;
  out.log_prior = density.log_prior;
  out.log_evidence_laplace = log_evidence(posterior, mode);
  out.fit = goodness_of_fit(residual_of(fit));
  out.identification = identification_of(in, fit, out.covariance);
  const auto checks = std::size_t(std::max(1, in.emulator.check_coarse + in.emulator.check_fine));
  out.check = check_by_true_model(in, fit, gaussian_draws(posterior, mode, checks, in.seed ^ check_stream).topRows(posterior.box().size()),
                                  in.emulator.check_coarse, in.emulator.check_fine);
  if (left_out) {
    auto directions = left_out(out.theta);
    if (out.trusted()) directions.insert(directions.begin(), gauge_gains(in.problem, out.calibrated));
    const Decimation& grid = fit.errors->grid();
    // The emulator's residuals at its runs are what a fit leaves where nothing is missing.
    if (!directions.empty()) out.score_tests = score_tests(posterior, mode.at, grid, directions, posterior.emulator().residuals(grid.apply(fit.histories())));
  }
  out.adequate = out.fit.adequate && !(out.score_tests && out.score_tests->stands_out);
  if (nested && fit.nested) out.nested = compare_nested(fit, *nested);
  return out;
}

}  // namespace calomel
