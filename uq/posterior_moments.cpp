#include "uq/posterior_moments.hpp"

#include <algorithm>

#include "uq/convergence/assess.hpp"
#include "uq/posterior_density.hpp"

namespace calomel {

SamplerStart start_at_mode(const LogPosterior& posterior, const LocalMode& mode) {
  Eigen::VectorXd by_u = Eigen::VectorXd::Ones(posterior.dimension());
  const auto& free = posterior.free();
  for (std::size_t i = 0; i < free.size(); ++i) by_u[Eigen::Index(i)] = 2 / std::max(0.05, 1 - mode.at.u[free[i]] * mode.at.u[free[i]]);
  return {.mean = posterior.q(mode.at.theta, mode.at.beyond), .covariance = by_u.asDiagonal() * mode.covariance * by_u.asDiagonal(), .points = {}};
}

SamplerResult short_chains(const LogPosterior& posterior, const LocalMode& mode, std::uint64_t seed) {
  const PosteriorDensity density(posterior);
  SamplerOptions options = default_sampler_options("dram");
  options.warmup = 1000, options.draws = 1500;  // some 800 independent draws
  return run_sampler(density, start_at_mode(posterior, mode), options, {.seed = seed, .journal = {}, .provenance = {}, .progress = {}});
}

Moments sampled_moments(const LogPosterior& posterior, const LocalMode& mode, std::uint64_t seed) {
  const auto summaries = assess(short_chains(posterior, mode, seed).quantities).parameters;
  const auto n = Eigen::Index(posterior.free().size());
  Moments m{Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) m.mean[i] = summaries[std::size_t(i)].mean, m.sd[i] = summaries[std::size_t(i)].sd;
  return m;
}

}  // namespace calomel
