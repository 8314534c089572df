#include "inverse/map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <limits>

#include "inverse/map_refine.hpp"
#include "inverse/polish.hpp"

namespace calomel {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double least_p_value = 0.01;

/// Scales of the discrepancy that are tried, over the local amplitude.
constexpr std::array<double, 8> discrepancy_scales{0, 0.005, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32};

/// The share of replicated data that would fit worse: chi-squared, or F for the multivariate t.
double tail(double chi2, double freedom, double of_scale) {
  if (!(freedom > 0)) return nan;
  if (std::isinf(of_scale)) return boost::math::cdf(boost::math::complement(boost::math::chi_squared(freedom), chi2));
  return boost::math::cdf(boost::math::complement(boost::math::fisher_f(freedom, of_scale), chi2 / freedom));
}

void judge(MapSummary& out, const Likelihood& likelihood, const Eigen::VectorXd& residual, std::size_t parameters, bool widen) {
  const auto& errors = likelihood.errors();
  out.values = std::size_t(errors.size());
  out.chi2 = errors.chi2(residual);
  out.effective_data = errors.effective_data(), out.effective_chi2 = errors.effective_chi2(residual);
  const double freedom = double(out.values) - double(parameters), effective = std::max(1.0, out.effective_data - double(parameters));
  out.p_value = tail(out.chi2, freedom, errors.freedom());
  out.effective_p_value = tail(out.effective_chi2, effective, errors.freedom());
  out.adequate = out.p_value >= least_p_value && out.effective_p_value >= least_p_value;
  if (widen && !out.adequate) out.widening = std::max({1.0, out.chi2 / freedom, out.effective_chi2 / effective});
  out.adequacy = fmt::format(
      "the fit is {}: chi-squared {:.4g} for {} values less {} parameters (p {:.2g}), {:.3g} for {:.3g} effective data (p {:.2g})",
      out.adequate ? "adequate" : "not adequate: the model leaves out more than noise and known errors explain", out.chi2, out.values, parameters, out.p_value,
      out.effective_chi2, out.effective_data, out.effective_p_value);
  if (out.widening > 1) out.adequacy += fmt::format("; standard deviations are widened by {:.3g}", std::sqrt(out.widening));
}

/// The discrepancy's scale by its posterior weight on a grid: half-normal prior times Laplace evidence; widens `best` to the mixture over the scales.
Likelihood with_discrepancy(MapSummary& out, MapSearch& search, const Problem& problem, const Likelihood& plain, const MapModels& models, const MapOptions& options,
                            std::vector<Optimum>& optima) {
  const Eigen::MatrixXd shape = discrepancy_shape(problem, plain.grid(), plain.data(), models.positions, options.discrepancy.distance, matern32(options.discrepancy.time));
  std::vector<Optimum> at_scale;
  std::vector<double> log_weight;
  std::vector<double> scales;
  Eigen::VectorXd x = optima[0].x;
  Eigen::VectorXd widths = 0.3 * optima[0].covariance.diagonal().cwiseSqrt();
  for (std::size_t i = discrepancy_scales.size(); i-- > 0;) {
    const double s = discrepancy_scales[i];
    const Likelihood l = plain.with("discrepancy", s * s * shape);
    const auto found = search.optima(l, {x}, {widths}, {});
    if (found.empty()) continue;
    // Weights of the trapezium rule over the scales.
    const double low = i > 0 ? discrepancy_scales[i - 1] : s, high = i + 1 < discrepancy_scales.size() ? discrepancy_scales[i + 1] : s;
    scales.push_back(s), at_scale.push_back(found[0]);
    log_weight.push_back(search.log_evidence(found[0]) - 0.5 * std::pow(s / options.discrepancy.scale, 2) + std::log(0.5 * (high - low)));
    x = found[0].x;
  }
  expect(!scales.empty(), "the mode that was found is found again");
  const auto best = std::size_t(std::max_element(log_weight.begin(), log_weight.end()) - log_weight.begin());
  double total = 0;
  for (const double w : log_weight) total += std::exp(w - log_weight[best]);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(x.size());
  Eigen::MatrixXd second = Eigen::MatrixXd::Zero(x.size(), x.size());
  for (std::size_t i = 0; i < scales.size(); ++i) {
    const double w = std::exp(log_weight[i] - log_weight[best]) / total;
    out.discrepancy_weights.emplace_back(scales[i], w);
    mean += w * at_scale[i].x, second += w * (at_scale[i].covariance + at_scale[i].x * at_scale[i].x.transpose());
  }
  out.discrepancy_scale = scales[best];
  optima[0] = at_scale[best];
  out.scale_spread = (second - mean * mean.transpose() - at_scale[best].covariance).trace() / at_scale[best].covariance.trace();
  return plain.with("discrepancy", out.discrepancy_scale * out.discrepancy_scale * shape);
}

/// Largest slope of the log posterior at x by the surrogate's own gradient, in units of the posterior sd.
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

}  // namespace

MapSummary run_map(const Problem& problem, const Recordings& recordings, const RecordingOptions& recording_options, const MapModels& models,
                   const MapOptions& options, std::uint64_t seed, int threads, const CalibrationProgress& progress) {
  const Clock clock;
  MapSummary out;
  out.objective = {"log_posterior", true, {}};
  out.product = options.product;
  out.nominal = nominal(problem.shape);
  out.warnings = problem.warnings;
  const bool physical = options.product == "physical";
  const SearchSpace space(physical ? with_handbook_priors(problem.shape.parameters) : problem.shape.parameters);
  const Bounds bounds = bounds_of(problem.shape);
  const Eigen::VectorXd box = space.high() - space.low();
  MapModels current = models;  // as it is refined
  MapSearch search(problem, recordings, recording_options, current, options, space, threads);

  // 1. The optima, by the likelihood as it is at the nominal point, then as it is at the best explanation.
  const Eigen::MatrixXd design = search.design(seed);
  std::optional<Likelihood> likelihood(search.likelihood(out.nominal, true));
  std::vector<Optimum> optima = search.global(likelihood, design, {}, progress);

  // 2. Runs of the true model, and of the finer mesh, where they tell most, until the optimum stays.
  if (!optima.empty()) {
    if (search.on_surrogate() && models.add_runs) optima = refine_search(out, search, current, models, design, std::move(optima), likelihood, seed, progress);
    if (models.unknown_directions) {
      current.unknowns = models.unknown_directions(space.theta(optima[0].x));
      likelihood.emplace(search.likelihood(space.theta(optima[0].x), true));
      std::vector<Eigen::VectorXd> starts;
      for (const auto& o : optima) starts.push_back(o.x);
      if (auto again = search.optima(*likelihood, starts, std::vector<Eigen::VectorXd>(starts.size(), 0.5 * optima[0].covariance.diagonal().cwiseSqrt()), progress); !again.empty())
        optima = std::move(again);
    }
    if (physical) likelihood.emplace(with_discrepancy(out, search, problem, *likelihood, models, options, optima));
    if (search.on_surrogate()) out.gradient = exact_slope(search.model(), *likelihood, space, optima[0]);
  }

  // 3. The final likelihood, that of the model which has the last word, and its candidates.
  const bool polished = options.polish && search.on_surrogate() && !optima.empty();
  const Likelihood* final_likelihood = &*likelihood;
  std::optional<Likelihood> of_model;
  if (polished) {
    of_model.emplace(search.likelihood(space.theta(optima[0].x), false));
    if (physical)
      of_model.emplace(of_model->with("discrepancy", std::pow(out.discrepancy_scale, 2) *
                                      discrepancy_shape(problem, of_model->grid(), of_model->data(), models.positions, options.discrepancy.distance, matern32(options.discrepancy.time))));
    final_likelihood = &*of_model;
  }
  const PosteriorMode on_search(search.model(), *final_likelihood, space, threads);
  std::vector<Proposal> ranked = proposals(optima, space);
  for (auto& p : ranked) p.cost = -on_search.at(space.from(p.theta)).log_posterior;
  ranked = well_separated(std::move(ranked), std::size_t(3 * options.candidates), options.separation, bounds);
  if (!search.on_surrogate())
    for (auto& p : ranked) p.cost = nan;
  out.search_s = clock.seconds();
  const double at_nominal = search.on_surrogate() ? -on_search.at(space.from(out.nominal)).log_posterior : nan;
  decide_by_true_model(out, problem, models.true_model, ranked, std::size_t(options.candidates), at_nominal, threads, progress,
                       [&](std::span<const double> theta, std::span<const double> values, const Score&) {
                         return final_likelihood->log_likelihood(theta, values) + space.log_prior(theta);
                       });
  out.evaluations = search.evaluations() + on_search.evaluations();
  if (!out.best.objective_model) return out;

  // 4. The true model itself, and the covariance by its secants.
  const Clock model_clock;
  const PosteriorMode on_model(models.true_model, *final_likelihood, space, threads);
  PosteriorPoint point{out.theta, out.calibrated, *out.best.objective_model};
  Eigen::VectorXd x = space.from(point.theta);
  const PosteriorMode& own = polished || !search.on_surrogate() ? on_model : on_search;
  std::optional<Linearisation> at;
  Eigen::MatrixXd covariance = optima.empty() ? Eigen::MatrixXd((0.01 * box.array().square()).matrix().asDiagonal()) : optima[0].covariance;
  const Eigen::VectorXd widths = space.secant_widths(x, search.secant() * covariance.diagonal().cwiseSqrt(), options.secant);
  std::vector<std::pair<Eigen::VectorXd, double>> known;  // points that the model was run at, and the log posterior there
  for (const auto& c : out.candidates)
    if (c.objective_model) known.emplace_back(space.from(c.theta), *c.objective_model);
  if (polished) {
    const Polished p = polish(on_model, space, point, covariance, widths, options.polish_runs,
                              [&](int done) { if (progress) progress("polishing runs", std::size_t(done), std::size_t(options.polish_runs)); });
    out.polish_steps = p.steps;
    at = p.at;
    for (const auto& t : p.tried) known.emplace_back(space.from(t.theta), t.log_posterior);
    if (p.steps > 0) {
      point = p.point, x = p.x;
      Candidate c{.theta = point.theta, .objective_surrogate = on_search.at(x).log_posterior, .objective_model = point.log_posterior};
      c.score = score(problem, point.history);
      out.best = c, out.theta = point.theta, out.calibrated = point.history;
      out.candidates.insert(out.candidates.begin(), std::move(c));
    }
  }
  if (!at) at = own.linearise(x, widths.asDiagonal());
  out.model_runs += on_model.evaluations();
  out.model_s += model_clock.seconds();

  // 5. What it is worth.
  const Eigen::VectorXd residual = final_likelihood->residual(point.theta, point.history);
  judge(out, *final_likelihood, residual, std::size_t(space.size()), options.widen);
  bool limited = true;
  Eigen::MatrixXd data = Eigen::MatrixXd::Zero(space.size(), space.size());
  if (at) {
    data = final_likelihood->errors().weight(at->chi2) * at->jacobian.transpose() * at->jacobian;
    covariance = covariance_of(own.curvature(*at), space, x, limited);
  } else {
    out.warnings.push_back("the model fails beside the optimum: the covariance is the search's");
  }
  out.log_likelihood = final_likelihood->log_likelihood(point.theta, point.history);
  out.log_prior = log_prior(space.priors(), point.theta);
  out.log_evidence_laplace = search.log_evidence({x, point.log_posterior, covariance});
  if (at) {
    for (Eigen::Index i = 0; i < at->points.cols(); ++i) known.emplace_back(at->points.col(i), at->log_posteriors[i]);
    Eigen::MatrixXd points(space.size(), Eigen::Index(known.size()));
    Eigen::VectorXd seen(points.cols());
    for (std::size_t i = 0; i < known.size(); ++i) points.col(Eigen::Index(i)) = known[i].first, seen[Eigen::Index(i)] = known[i].second;
    out.curvature_seen = seen_curvature(points, seen, x, point.log_posterior, covariance);
  }
  // Optima that the model's roughness cannot tell apart belong to the answer: how far surrogate and model disagree on their log posteriors is the
  // temperature at which they are weighed.
  std::vector<std::pair<Eigen::VectorXd, double>> rivals;
  double apart = 0, disagreement = 0;
  for (const auto& c : out.candidates)
    if (c.objective_model && std::isfinite(c.objective_surrogate)) rivals.emplace_back(space.from(c.theta), *c.objective_model), apart += c.objective_surrogate - *c.objective_model;
  for (const auto& c : out.candidates)
    if (c.objective_model && std::isfinite(c.objective_surrogate))
      disagreement += std::pow(c.objective_surrogate - *c.objective_model - apart / double(rivals.size()), 2);
  if (rivals.size() > 1) out.roughness = std::sqrt(disagreement / double(rivals.size() - 1));
  const Eigen::MatrixXd between = spread_of(rivals, x, point.log_posterior, std::max(1.0, out.roughness));
  const double flatter = std::clamp(out.curvature_seen, 0.01, 1.0);
  covariance *= out.widening / flatter * (1 + std::max(0.0, out.scale_spread));
  covariance += between;
  const Eigen::VectorXd by_x = space.slope(x);
  out.covariance = by_x.asDiagonal() * covariance * by_x.asDiagonal();
  const Eigen::MatrixXd data_own = by_x.cwiseInverse().asDiagonal() * data * by_x.cwiseInverse().asDiagonal();
  out.identification = identify(problem.shape.parameters, point.theta, data_own, out.covariance, space.prior_sd(x).cwiseProduct(by_x), out.widening / flatter);
  if (!current.mesh.empty() && at) judge_mesh(out, problem, current.mesh, *final_likelihood, at->jacobian, covariance, point.history);
  out.shares = final_likelihood->shares();
  out.energy_sd = final_likelihood->noise().energy_sd, out.split_half = final_likelihood->noise().split_half;
  for (const auto& s : final_likelihood->noise().series) out.noise_time.push_back(s.time);
  out.message = fmt::format("log posterior {:.6g} in the true model; {}", point.log_posterior, out.adequacy);
  warn(out, space, x, covariance, limited);
  return out;
}

}  // namespace calomel
