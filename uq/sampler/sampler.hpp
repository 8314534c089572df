#pragma once
/// Runs several chains of one sampler on any LogDensity from dispersed starts. Chains are saved as they go; after any kill they resume to the same draws.
#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/provenance.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/draws.hpp"
#include "uq/log_density.hpp"
#include "uq/sampler/sampler_options.hpp"
#include "uq/sampler/start.hpp"

namespace calomel {

/// Where chains begin.
struct SamplerStart {
  Eigen::VectorXd mean;        ///< (d), e.g. the mode
  Eigen::MatrixXd covariance;  ///< (d, d), e.g. Laplace's; the unit matrix when empty
  Eigen::MatrixXd points;  ///< (d, chains), when the caller has starts of its own; else they are drawn about `mean`, dispersion times as wide as `covariance`
  /// Several modes replace `mean` and `covariance`: chain k starts about mode k modulo their number, and after each transition its points try a jump
  /// (jumps.hpp). A sampler without jumps may draw its points about all of them.
  std::vector<StartMode> modes = {};
};

/// Receives the transitions done and their total over the chains, those of earlier calls included, now and then; never from two threads at once.
using SamplerProgress = std::function<void(std::size_t done, std::size_t all)>;

/// How a run is carried out. Its draws depend on the seed alone.
struct SamplerRun {
  std::uint64_t seed = 1;
  int threads = 1;
  std::filesystem::path journal;  ///< where chains are saved; an empty path saves nothing
  Provenance provenance;          ///< what the draws depend on; it is written into the journal
  double save_every = 5;          ///< [s]
  SamplerProgress progress;
  const std::atomic<bool>* stop = nullptr;
};

struct SamplerSummary {
  std::string kind;                          ///< the sampler's name
  SamplerRemedies remedies;                  ///< the sampler's own
  std::vector<double> acceptance;            ///< (sampler.chains) mean over the kept transitions
  std::size_t evaluations = 0;               ///< evaluations of the density that is sampled, warm-up and earlier calls included
  std::size_t cheap_evaluations = 0;         ///< evaluations of the cheap density of a sampler of two densities
  std::size_t transitions = 0;               ///< transitions of all chains, warm-up included
  std::size_t resumed = 0;                   ///< transitions among these that earlier calls made
  std::vector<double> e_bfmi;                ///< (sampler.chains) of the kept transitions, see e_bfmi(); empty where the sampler has no momenta
  std::size_t divergences = 0;               ///< kept transitions whose trajectory diverged
  std::size_t cut = 0;                       ///< kept transitions that the greatest number of doublings ended
  std::optional<double> log_evidence;        ///< ln of the integral of the density over its coordinates, the mean of the chains' estimates, if estimated
  std::optional<double> log_evidence_error;  ///< its standard error, of two chains or more
  double wall_s = 0;                         ///< wall time of this call [s]
};

/// The draws. Each walker of each of sampler.chains is a chain here.
struct SamplerResult {
  SamplerSummary summary;
  Draws coordinates;                ///< in the density's own coordinates
  Draws quantities;                 ///< the quantities that constrain() makes of them
  std::vector<double> log_density;  ///< (chain, draw)
  std::vector<double> acceptance;   ///< (chain, draw), mean over the draw's transitions
  // The next three are (chain, draw) for samplers along trajectories and empty for others.
  std::vector<double> energy;     ///< of the draw's last transition [-]
  std::vector<double> diverging;  ///< transitions of the draw that diverged
  std::vector<double> depth;      ///< doublings of the draw's last transition
};

/// Runs options.chains chains of options.warmup + options.draws * options.thin transitions. Chain k draws its start and its transitions from
/// RandomStream(seed, k) alone. A start with density zero is refused and drawn again, each time nearer to the mean.
/// With a journal, every chain is saved each save_every seconds and when it stops. The same call resumes there and ends with the same draws. The caller removes
/// the journal (remove_journal) once the draws are stored. Errors: InputError when the journal belongs to other settings, when the disk is full, or when the
/// density lacks what the sampler needs (a gradient, a second density); NumericsError when no start has a positive density, or the density is NaN somewhere;
/// Interrupted when `stop` became true; and whatever the density throws.
[[nodiscard]] SamplerResult run_sampler(const LogDensity& density, const SamplerStart& start, const SamplerOptions& options, const SamplerRun& run);
/// The same for a sampler of two densities on the same coordinates: `exact` is sampled, the first stage proposes on `cheap`. Quantities and names are those of
/// `exact`. Errors: as above, and InputError for a sampler of one density.
[[nodiscard]] SamplerResult run_sampler(const LogDensity& cheap, const LogDensity& exact, const SamplerStart& start, const SamplerOptions& options,
                                        const SamplerRun& run);

/// The facts of a run that assess() takes beside its draws.
[[nodiscard]] SamplingFacts sampling_facts(const SamplerResult& result, int thin);

/// Deletes the journal of a run whose draws are stored. Nothing happens when there is none. Errors: InputError when it cannot be deleted.
void remove_journal(const std::filesystem::path& journal);

}  // namespace calomel
