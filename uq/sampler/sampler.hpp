#pragma once
/// Samplers: several chains of one kind on any LogDensity, dispersed starts, saved as they go, resumed after any kill to the same draws.
#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/provenance.hpp"
#include "base/registry.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/draws.hpp"
#include "uq/log_density.hpp"
#include "uq/sampler/delayed_acceptance.hpp"
#include "uq/sampler/dram.hpp"
#include "uq/sampler/ensemble.hpp"
#include "uq/sampler/nuts.hpp"
#include "uq/sampler/smc.hpp"
#include "uq/sampler/start.hpp"

namespace calomel {

struct SamplerOptions;

/// What a chain is made of; all outlives it.
struct ChainSetting {
  const LogDensity& density;  ///< that is sampled; with `exact`, its cheap stand-in
  const LogDensity* exact;    ///< that is sampled by a sampler of two densities; else null
  const SamplerOptions& options;
  const StartMode& mode;                ///< about which the chain starts, and what is known of the density's shape there beforehand
  const std::vector<StartMode>& modes;  ///< all that are known
};

/// A kind of sampler.
struct SamplerEntry {
  /// Makes one chain. Errors: InputError when the covariance is not positive definite or the density has not what the sampler needs.
  std::function<std::unique_ptr<MarkovChain>(const ChainSetting& setting)> chain;
  int warmup, draws, thin;  ///< defaults of SamplerOptions where a case asks for this kind
  /// Of the density, a transition of one chain: what is usual, for a forecast. dimension: of the density.
  std::function<double(const SamplerOptions& options, std::size_t dimension)> evaluations;
};
/// dram, nuts, ensemble, smc, delayed_acceptance.
const Registry<SamplerEntry>& samplers();

/// `[sampler]` of a case file.
struct SamplerOptions {
  std::string kind = "dram";
  int chains = 4;
  int warmup = 5000;
  int draws = 10000;
  int thin = 4;
  double dispersion = 2;
  DramOptions dram;
  NutsOptions nuts;
  WalkerOptions ensemble;
  SmcOptions smc;
  DelayedAcceptanceOptions delayed_acceptance;

  template <class V>
  void visit(V& v) {
    v("kind", kind, {.doc = "how chains move", .choices = samplers().names()});
    v("chains", chains, {.range = between(1, 1000), .doc = "chains, each from a start of its own; four or more tell whether they agree"});
    v("warmup", warmup,
      {.range = at_least(0),
       .doc = "transitions of each chain in which the proposal is learnt; they are left out. This default and the next two are dram's; the other kinds' are in "
              "theory/sampling.md"});
    v("draws", draws, {.range = at_least(1), .doc = "draws of each chain that are kept"});
    v("thin", thin, {.range = at_least(1), .doc = "transitions a kept draw; above 1 it saves space: neighbouring draws of a chain are much alike"});
    v("dispersion", dispersion, {.range = between(0, 100), .doc = "starts are drawn with this many times the deviations of the mode's covariance"});
    v.table("dram", dram, "delayed rejection adaptive Metropolis");
    v.table("nuts", nuts, "no-U-turn sampler");
    v.table("ensemble", ensemble, "walkers that propose by one another's places");
    v.table("smc", smc, "particles through tempered densities");
    v.table("delayed_acceptance", delayed_acceptance, "the emulator first, the true model second");
  }
};

/// Of the density that is sampled, in a whole run without resuming: a forecast by what is usual of the kind, in [docs/theory/sampling.md]. Densities that are
/// hard to walk on take several times as many. Errors: InputError for an unknown kind.
[[nodiscard]] double usual_evaluations(const SamplerOptions& options, std::size_t dimension);

/// Defaults of a kind. Errors: InputError for an unknown one.
[[nodiscard]] SamplerOptions default_sampler_options(const std::string& kind);

/// Where chains begin.
struct SamplerStart {
  Eigen::VectorXd mean;        ///< (d), e.g. the mode
  Eigen::MatrixXd covariance;  ///< (d, d), e.g. Laplace's; the unit matrix when empty
  Eigen::MatrixXd points;  ///< (d, chains), when the caller has starts of its own; else they are drawn about `mean`, dispersion times as wide as `covariance`
  /// Where there is more than one, in place of `mean` and `covariance`: chain k starts about mode k modulo their number, and after each transition its points
  /// try a jump (jumps.hpp). smc, which needs none, draws its particles about all of them.
  std::vector<StartMode> modes = {};
};

/// Told now and then: transitions done and in all, over the chains, those of earlier calls included. Never from two threads at once.
using SamplerProgress = std::function<void(std::size_t done, std::size_t all)>;

/// How a run is carried out; its draws depend on the seed alone.
struct SamplerRun {
  std::uint64_t seed = 1;
  int threads = 1;
  std::filesystem::path journal;  ///< where chains are saved; empty: nowhere
  Provenance provenance;          ///< of the journal: what the draws depend on
  double save_every = 5;          ///< [s]
  SamplerProgress progress;
  const std::atomic<bool>* stop = nullptr;
};

struct SamplerSummary {
  std::string kind;                   ///< of the sampler
  std::vector<double> acceptance;     ///< (sampler.chains) mean over the kept transitions
  std::size_t evaluations = 0;        ///< of the density that is sampled, warm-up and earlier calls included
  std::size_t cheap_evaluations = 0;  ///< of its cheap stand-in, where there is one
  std::size_t transitions = 0;        ///< over the chains, warm-up included
  std::size_t resumed = 0;            ///< of these, from earlier calls
  std::vector<double> e_bfmi;         ///< (sampler.chains) of the kept transitions, see e_bfmi(); empty where the sampler has no momenta
  std::size_t divergences = 0;        ///< kept transitions whose trajectory was given up
  std::size_t cut = 0;                ///< kept transitions that the greatest number of doublings ended
  std::optional<double>
      log_evidence;  ///< ln of the integral of the density over its coordinates, the mean of the chains' estimates; where the sampler makes one
  std::optional<double> log_evidence_error;  ///< its standard error, of two chains or more
  double wall_s = 0;                         ///< of this call [s]
};

/// Each walker of each of sampler.chains is a chain here.
struct SamplerResult {
  SamplerSummary summary;
  Draws coordinates;                ///< in the density's own coordinates
  Draws quantities;                 ///< what constrain() makes of them
  std::vector<double> log_density;  ///< (chain, draw)
  std::vector<double> acceptance;   ///< (chain, draw), mean over the draw's transitions
  // Of samplers along trajectories alone, (chain, draw).
  std::vector<double> energy;     ///< of the draw's last transition [-]
  std::vector<double> diverging;  ///< transitions of the draw that were given up
  std::vector<double> depth;      ///< doublings of the draw's last transition
};

/// Runs options.chains chains of options.warmup + options.draws * options.thin transitions. Chain k draws from RandomStream(seed, k) alone: its start, then its
/// transitions. A start is refused and drawn anew, each time nearer to the mean, while the density is zero there.
/// With a journal, every chain is saved each save_every seconds and when it stops; the same call goes on from there and ends with the same draws. The caller
/// removes the journal (remove_journal) once the draws are where they belong. Errors: InputError when the journal is of other settings, the disk is full, or
/// the sampler needs what the density has not (a gradient, a second density); NumericsError when no start has a positive density, or the density is NaN
/// somewhere; Interrupted when `stop` became true; whatever the density throws.
[[nodiscard]] SamplerResult run_sampler(const LogDensity& density, const SamplerStart& start, const SamplerOptions& options, const SamplerRun& run);
/// Of two densities on the same coordinates: `exact` is sampled, `cheap` stands in for it where the sampler has a first stage. Quantities and names are those
/// of `exact`. Errors: as above, and InputError for a sampler of one density.
[[nodiscard]] SamplerResult run_sampler(const LogDensity& cheap, const LogDensity& exact, const SamplerStart& start, const SamplerOptions& options,
                                        const SamplerRun& run);

/// What assess() is told of a run beside its draws.
[[nodiscard]] SamplingFacts sampling_facts(const SamplerResult& result, int thin);

/// Deletes the journal of a run whose draws are safe; nothing happens when there is none.
void remove_journal(const std::filesystem::path& journal);

}  // namespace calomel
