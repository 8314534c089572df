#pragma once
/// Mean and standard deviations of a case's posterior, by draws.
#include <cstdint>

#include "inverse/posterior/posterior_fit.hpp"
#include "uq/sampler/modes.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel {

/// At a mode, with Laplace's covariance carried to q: du/dq = (1 - u^2) / 2.
[[nodiscard]] SamplerStart start_at_mode(const LogPosterior& posterior, const LocalMode& mode);

/// All modes that lie in the emulator's box: those that `modes` and a design over it lead to. modes: of find_modes, one or more.
[[nodiscard]] std::vector<LaplaceMode> modes_in_box(const LogPosterior& posterior, const std::vector<LocalMode>& modes, std::uint64_t seed, int threads);
/// At all of `found` (modes_in_box). Where that is one, as start_at_mode of modes[0], unless it lies far above that.
[[nodiscard]] SamplerStart start_at_modes(const LogPosterior& posterior, const std::vector<LocalMode>& modes, const std::vector<LaplaceMode>& found);

/// Four short chains of `dram`, some 800 independent draws: (chain, draw) in the density's coordinates and in natural units. One thread; the same seed gives
/// the same draws. Errors: those of run_sampler.
[[nodiscard]] SamplerResult short_chains(const LogPosterior& posterior, const SamplerStart& start, std::uint64_t seed);

/// Of the free parameters, in the order of LogPosterior::free(), natural units.
struct Moments {
  Eigen::VectorXd mean, sd;
};

/// By short_chains from the mode, so that the mean is known to some 4 % of a deviation: where a bound or the edge of the box cuts the posterior, its mode and
/// Laplace's covariance tell neither. Errors: those of run_sampler.
[[nodiscard]] Moments sampled_moments(const LogPosterior& posterior, const LocalMode& mode, std::uint64_t seed);

}  // namespace calomel
