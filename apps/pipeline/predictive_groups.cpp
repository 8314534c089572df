#include "apps/pipeline/predictive_groups.hpp"

#include <algorithm>

#include "base/random.hpp"

namespace calomel {

namespace {

constexpr std::size_t predictive_draws = 25;  ///< of each chain
constexpr std::size_t prior_draws = 1000;

}  // namespace

Predicting predicting(const PosteriorFit& fit, const std::vector<Parameter>& parameters) {
  return {.parameters = parameters,
          .priors = fit.posterior->priors(),
          .log_likelihood = [&fit](const Eigen::VectorXd& q) { return fit.posterior->density(fit.posterior->point(q)).log_likelihood; },
          .history = [&fit](const Eigen::VectorXd& q) {
            const auto at = fit.posterior->point(q);
            return fit.history(at.u, at.beyond);
          }};
}

PosteriorGroup prior_group(const std::vector<Parameter>& parameters, const std::vector<Prior>& priors, std::uint64_t seed) {
  PosteriorGroup prior{.name = "prior", .chains = 1, .draws = prior_draws, .coordinates = {}, .variables = {}};
  RandomStream random(seed, 0x9107);
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    PosteriorVariable v{.name = parameters[k].name, .unit = "", .dims = {}, .values = {}};
    for (std::size_t i = 0; i < prior_draws; ++i) v.values.push_back(priors[k].quantile(std::clamp(random.uniform(), 1e-12, 1 - 1e-12)));
    prior.variables.push_back(std::move(v));
  }
  return prior;
}

std::vector<PosteriorGroup> predictive_groups(const Predicting& of, const Problem& problem, const SamplerResult& result, std::uint64_t seed) {
  const auto& shape = problem.shape;
  const PosteriorCoordinate sensor{.name = "sensor", .unit = "", .numbers = {}, .words = shape.sensors}, time{.name = "time", .unit = "s", .numbers = shape.times, .words = {}},
      record_time{.name = "record_time", .unit = "s", .numbers = problem.time, .words = {}}, condition{.name = "condition", .unit = "", .numbers = {}, .words = shape.conditions};
  const bool many = shape.conditions.size() > 1;
  const auto dims = [&](const std::string& last) { return many ? std::vector<std::string>{"condition", "sensor", last} : std::vector<std::string>{"sensor", last}; };
  const auto coordinates = [&](const PosteriorCoordinate& last) { return many ? std::vector<PosteriorCoordinate>{condition, sensor, last} : std::vector<PosteriorCoordinate>{sensor, last}; };
  const std::string unit = shape.unit == "strain" ? "1" : shape.unit;
  const auto point_at = [&](std::size_t chain, std::size_t draw) {
    Eigen::VectorXd q(Eigen::Index(result.coordinates.names.size()));
    for (Eigen::Index k = 0; k < q.size(); ++k) q[k] = result.coordinates.at(chain, draw, std::size_t(k));
    return q;
  };

  PosteriorGroup predictive{.name = "posterior_predictive", .chains = result.coordinates.chains, .draws = std::min(predictive_draws, result.coordinates.draws), .coordinates = coordinates(time), .variables = {}};
  PosteriorVariable strain{.name = "strain", .unit = unit, .dims = dims("time"), .values = {}};
  for (std::size_t c = 0; c < predictive.chains; ++c)
    for (std::size_t i = 0; i < predictive.draws; ++i) {
      const std::size_t draw = (i + 1) * result.coordinates.draws / predictive.draws - 1;
      const Eigen::VectorXd y = of.history(point_at(c, draw));
      strain.values.insert(strain.values.end(), y.begin(), y.end());
    }
  predictive.variables.push_back(std::move(strain));

  PosteriorGroup observed{.name = "observed_data", .coordinates = coordinates(record_time), .variables = {}};
  observed.variables.push_back({.name = "strain", .unit = unit, .dims = dims("record_time"), .values = band_arrays(problem).mean});

  std::vector<PosteriorGroup> out;
  if (of.log_likelihood) out.push_back({.name = "log_likelihood", .chains = result.coordinates.chains, .draws = result.coordinates.draws, .coordinates = {}, .variables = {}});
  if (of.log_likelihood) {
    PosteriorVariable records{.name = "records", .unit = "", .dims = {}, .values = {}};
    for (std::size_t c = 0; c < result.coordinates.chains; ++c)
      for (std::size_t i = 0; i < result.coordinates.draws; ++i) records.values.push_back(of.log_likelihood(point_at(c, i)));
    out[0].variables.push_back(std::move(records));
  }
  out.push_back(std::move(predictive)), out.push_back(std::move(observed)), out.push_back(prior_group(of.parameters, of.priors, seed));
  return out;
}

}  // namespace calomel
