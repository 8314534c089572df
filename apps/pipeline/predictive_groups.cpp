#include "apps/pipeline/predictive_groups.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.hpp"

namespace calomel {

namespace {

constexpr std::size_t predictive_draws = 25;  ///< of each chain, or of all walkers of an ensemble, two each at least
constexpr std::size_t prior_draws = 1000;

}  // namespace

Predicting predicting(const PosteriorFit& fit, const std::vector<Parameter>& parameters) {
  // Of the likelihoods of a mixture each with its weight at the mode; the emulator's own variance is a multiple of the numerical noise's.
  const auto density = fit.posterior->density(fit.modes[0].at);
  Eigen::VectorXd variance = density.variance * fit.noise.diagonal();
  for (std::size_t j = 0; j < fit.hypotheses.size(); ++j)
    for (const auto& term : fit.hypotheses[j].errors.terms()) variance += (fit.hypotheses.size() > 1 ? density.weights[j] : 1.0) * term.covariance.diagonal();
  return {
      .parameters = parameters,
      .priors = fit.posterior->priors(),
      .log_prior =
          [&fit](const Eigen::VectorXd& q) { return fit.posterior->log_density(q) - fit.posterior->density(fit.posterior->point(q), false).log_likelihood; },
      .history =
          [&fit](const Eigen::VectorXd& q) {
            const auto at = fit.posterior->point(q);
            return fit.history(at.u, at.beyond);
          },
      .error_variance = std::move(variance),
      .grid = &fit.errors->grid()};
}

PosteriorGroup prior_group(const std::vector<Parameter>& parameters, const std::vector<Prior>& priors, std::uint64_t seed) {
  PosteriorGroup prior{.name = "prior", .chains = 1, .draws = prior_draws, .coordinates = {}, .variables = {}};
  RandomStream random(seed, 0x9107);
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const auto& p = parameters[k];
    PosteriorVariable v{.name = p.name, .unit = p.unit, .dims = {}, .values = {}};
    const double below = priors[k].probability_below(p.min), within = priors[k].probability_below(p.max) - below;
    for (std::size_t i = 0; i < prior_draws; ++i)
      v.values.push_back(std::clamp(priors[k].quantile(std::clamp(below + within * random.uniform(), 1e-12, 1 - 1e-12)), p.min, p.max));
    prior.variables.push_back(std::move(v));
  }
  return prior;
}

std::vector<double> error_sd(const Problem& problem, const Decimation& grid, const Eigen::VectorXd& variance) {
  std::vector<double> out = band_arrays(problem).mean;
  for (std::size_t o = 0; o < problem.observations.size(); ++o) {
    const auto& of = problem.observations[o];
    const auto windows = grid.windows(o);
    double* at = out.data() + (of.condition * problem.shape.sensors.size() + of.sensor) * problem.time.size();
    const auto value = [&](std::size_t w) { return std::sqrt(std::max(0.0, variance[Eigen::Index(grid.offset(o) + w)])); };
    for (std::size_t i = 0, w = 0; i < problem.time.size(); ++i) {
      if (windows.empty()) at[i] = std::numeric_limits<double>::quiet_NaN();
      if (!std::isfinite(at[i])) continue;
      const double t = problem.time[i];
      while (w + 1 < windows.size() && windows[w + 1].time <= t) ++w;
      if (t <= windows[w].time || w + 1 == windows.size()) {
        at[i] = value(w);
      } else {
        const double share = (t - windows[w].time) / (windows[w + 1].time - windows[w].time);
        at[i] = (1 - share) * value(w) + share * value(w + 1);
      }
    }
  }
  return out;
}

std::vector<PosteriorGroup> predictive_groups(const Predicting& of, const Problem& problem, const SamplerResult& result, std::uint64_t seed) {
  const auto& shape = problem.shape;
  const PosteriorCoordinate sensor{.name = "sensor", .unit = "", .numbers = {}, .words = shape.sensors},
      time{.name = "time", .unit = "s", .numbers = shape.times, .words = {}},
      record_time{.name = "record_time", .unit = "s", .numbers = problem.time, .words = {}},
      condition{.name = "condition", .unit = "", .numbers = {}, .words = shape.conditions};
  const bool many = shape.conditions.size() > 1;
  const auto dims = [&](const std::string& last) {
    return many ? std::vector<std::string>{"condition", "sensor", last} : std::vector<std::string>{"sensor", last};
  };
  const auto coordinates = [&](const PosteriorCoordinate& last) {
    return many ? std::vector<PosteriorCoordinate>{condition, sensor, last} : std::vector<PosteriorCoordinate>{sensor, last};
  };
  const std::string unit = shape.unit == "strain" ? "1" : shape.unit;
  const auto point_at = [&](std::size_t chain, std::size_t draw) {
    Eigen::VectorXd q(Eigen::Index(result.coordinates.names.size()));
    for (Eigen::Index k = 0; k < q.size(); ++k) q[k] = result.coordinates.at(chain, draw, std::size_t(k));
    return q;
  };

  PosteriorGroup predictive{.name = "posterior_predictive",
                            .chains = result.coordinates.chains,
                            .draws = std::min(std::max<std::size_t>(2, predictive_draws / result.coordinates.walkers), result.coordinates.draws),
                            .coordinates = coordinates(time),
                            .variables = {}};
  PosteriorVariable strain{.name = "strain", .unit = unit, .dims = dims("time"), .values = {}};
  for (std::size_t c = 0; c < predictive.chains; ++c)
    for (std::size_t i = 0; i < predictive.draws; ++i) {
      const std::size_t draw = (i + 1) * result.coordinates.draws / predictive.draws - 1;
      if (c == 0) predictive.draw_numbers.push_back(int(draw));
      const Eigen::VectorXd y = of.history(point_at(c, draw));
      strain.values.insert(strain.values.end(), y.begin(), y.end());
    }
  predictive.variables.push_back(std::move(strain));

  PosteriorGroup observed{.name = "observed_data", .coordinates = coordinates(record_time), .variables = {}};
  BandArrays bands = band_arrays(problem);
  observed.variables.push_back({.name = "strain", .unit = unit, .dims = dims("record_time"), .values = std::move(bands.mean)});
  observed.variables.push_back({.name = "strain_low", .unit = unit, .dims = dims("record_time"), .values = std::move(bands.low)});
  observed.variables.push_back({.name = "strain_high", .unit = unit, .dims = dims("record_time"), .values = std::move(bands.high)});
  if (of.grid)
    observed.variables.push_back({.name = "error_sd", .unit = unit, .dims = dims("record_time"), .values = error_sd(problem, *of.grid, of.error_variance)});

  PosteriorGroup likelihood{
      .name = "log_likelihood", .chains = result.coordinates.chains, .draws = result.coordinates.draws, .coordinates = {}, .variables = {}};
  PosteriorVariable records{.name = "records", .unit = "", .dims = {}, .values = result.log_density};
  for (std::size_t c = 0; c < likelihood.chains; ++c)
    for (std::size_t i = 0; i < likelihood.draws; ++i) records.values[c * likelihood.draws + i] -= of.log_prior(point_at(c, i));
  likelihood.variables.push_back(std::move(records));
  return {std::move(likelihood), std::move(predictive), std::move(observed), prior_group(of.parameters, of.priors, seed)};
}

}  // namespace calomel
