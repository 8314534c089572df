#pragma once
/// Mean and standard deviations of a case's posterior, by sampling; and the starts of its chains.
#include <cstdint>

#include "inverse/posterior/posterior_fit.hpp"
#include "uq/sampler/modes.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel {

/// A start at a mode, with Laplace's covariance transformed to q: du/dq = (1 - u^2) / 2.
[[nodiscard]] SamplerStart start_at_mode(const LogPosterior& posterior, const LocalMode& mode);

/// All modes in the emulator's box that searches from `modes` and from a design over the box find. modes: one or more, from find_modes.
[[nodiscard]] std::vector<LaplaceMode> modes_in_box(const LogPosterior& posterior, const std::vector<LocalMode>& modes, std::uint64_t seed, int threads);
/// A start at all modes of `found` (modes_in_box). Where there is one, it is start_at_mode of modes[0], unless the one found lies far above that.
[[nodiscard]] SamplerStart start_at_modes(const LogPosterior& posterior, const std::vector<LocalMode>& modes, const std::vector<LaplaceMode>& found);

/// Four short chains of the default sampler, with some 800 independent draws: (chain, draw) in the density's coordinates and in natural units. They run on one
/// thread, and the same seed gives the same draws. Errors: those of run_sampler.
[[nodiscard]] SamplerResult short_chains(const LogPosterior& posterior, const SamplerStart& start, std::uint64_t seed);

/// Mean and standard deviations of the free parameters, in the order of LogPosterior::free(), in natural units.
struct Moments {
  Eigen::VectorXd mean;
  Eigen::VectorXd sd;
};

/// The moments by short_chains from the mode, with which the mean is known to some 4 % of a standard deviation. Where a bound or the edge of the box cuts the
/// posterior, the mode and Laplace's covariance give neither. Errors: those of run_sampler.
[[nodiscard]] Moments sampled_moments(const LogPosterior& posterior, const LocalMode& mode, std::uint64_t seed);

}  // namespace calomel
