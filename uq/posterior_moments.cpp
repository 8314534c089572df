#include "uq/posterior_moments.hpp"

#include <algorithm>

#include "forward/campaign/design.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/posterior_density.hpp"

namespace calomel {

namespace {

constexpr std::size_t design_points = 128;
constexpr double inner = 0.9;    ///< half width of the design over that of the box
constexpr double far_above = 1;  ///< difference of the log density that means another mode, or a search that ended early

}  // namespace

SamplerStart start_at_mode(const LogPosterior& posterior, const LocalMode& mode) {
  Eigen::VectorXd by_u = Eigen::VectorXd::Ones(posterior.dimension());
  const auto& free = posterior.free();
  for (std::size_t i = 0; i < free.size(); ++i) by_u[Eigen::Index(i)] = 2 / std::max(0.05, 1 - mode.at.u[free[i]] * mode.at.u[free[i]]);
  return {.mean = posterior.q(mode.at.theta, mode.at.beyond), .covariance = by_u.asDiagonal() * mode.covariance * by_u.asDiagonal(), .points = {}};
}

std::vector<LaplaceMode> modes_in_box(const LogPosterior& posterior, const std::vector<LocalMode>& modes, std::uint64_t seed, int threads) {
  const EmulatorBox& box = posterior.box();
  const Eigen::MatrixXd unit = space_filling_points(std::size_t(box.size()), design_points, seed);
  Eigen::MatrixXd design(posterior.dimension(), unit.cols());
  Eigen::MatrixXd starts(posterior.dimension(), Eigen::Index(modes.size()));
  for (Eigen::Index i = 0; i < unit.cols(); ++i) design.col(i) = posterior.q(box.theta(inner * (2 * unit.col(i).array() - 1).matrix()), 0);
  for (std::size_t i = 0; i < modes.size(); ++i) starts.col(Eigen::Index(i)) = posterior.q(modes[i].at.theta, modes[i].at.beyond);
  return density_modes(PosteriorDensity(posterior), design, starts, threads);
}

SamplerStart start_at_modes(const LogPosterior& posterior, const std::vector<LocalMode>& modes, const std::vector<LaplaceMode>& found) {
  const double at_first = posterior.log_density(posterior.q(modes[0].at.theta, modes[0].at.beyond));
  return found.size() > 1 || found[0].log_density > at_first + far_above ? start_at_modes(found) : start_at_mode(posterior, modes[0]);
}

SamplerResult short_chains(const LogPosterior& posterior, const SamplerStart& start, std::uint64_t seed) {
  const PosteriorDensity density(posterior);
  SamplerOptions options;
  options.warmup = 1000;
  options.draws = 1500;  // some 800 independent draws
  return run_sampler(density, start, options, {.seed = seed, .journal = {}, .provenance = {}, .progress = {}});
}

Moments sampled_moments(const LogPosterior& posterior, const LocalMode& mode, std::uint64_t seed) {
  const auto summaries = assess(short_chains(posterior, start_at_mode(posterior, mode), seed).quantities).parameters;
  const auto n = Eigen::Index(posterior.free().size());
  Moments m{Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    m.mean[i] = summaries[std::size_t(i)].mean;
    m.sd[i] = summaries[std::size_t(i)].sd;
  }
  return m;
}

}  // namespace calomel
