#pragma once
/// Mean and standard deviations of a case's posterior, by draws.
#include <cstdint>

#include "inverse/posterior/posterior_fit.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel {

/// At a mode, with Laplace's covariance carried to q: du/dq = (1 - u^2) / 2.
[[nodiscard]] SamplerStart start_at_mode(const LogPosterior& posterior, const LocalMode& mode);

/// At all modes that lie in the emulator's box, among `modes` and those that a design over it leads to; as start_at_mode where there is one. modes: of find_modes, one or more.
[[nodiscard]] SamplerStart start_at_modes(const LogPosterior& posterior, const std::vector<LocalMode>& modes, std::uint64_t seed, int threads);

/// Four short chains of `dram` from the mode, some 800 independent draws: (chain, draw) in the density's coordinates and in natural units. One thread; the same seed gives the
/// same draws. Errors: those of run_sampler.
[[nodiscard]] SamplerResult short_chains(const LogPosterior& posterior, const LocalMode& mode, std::uint64_t seed);

/// Of the free parameters, in the order of LogPosterior::free(), natural units.
struct Moments {
  Eigen::VectorXd mean, sd;
};

/// By short_chains, so that the mean is known to some 4 % of a deviation: where a bound or the edge of the box cuts the posterior, its mode and Laplace's covariance tell neither. Errors: those of run_sampler.
[[nodiscard]] Moments sampled_moments(const LogPosterior& posterior, const LocalMode& mode, std::uint64_t seed);

}  // namespace calomel
