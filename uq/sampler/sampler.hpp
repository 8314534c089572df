#pragma once
/// Samplers: several chains of one kind on any LogDensity, dispersed starts, saved as they go, resumed after any kill to the same draws.
#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/provenance.hpp"
#include "base/registry.hpp"
#include "uq/draws.hpp"
#include "uq/log_density.hpp"
#include "uq/sampler/dram.hpp"

namespace calomel {

struct SamplerOptions;

/// Makes one chain. covariance: (d, d), what is known of the density's shape beforehand. Errors: InputError when it is not positive definite.
using SamplerEntry = std::function<std::unique_ptr<MarkovChain>(const LogDensity& density, const SamplerOptions& options, const Eigen::MatrixXd& covariance)>;
/// dram.
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

  template <class V>
  void visit(V& v) {
    v("kind", kind, {.doc = "how chains move", .choices = samplers().names()});
    v("chains", chains, {.range = between(1, 1000), .doc = "chains, each from a start of its own; four or more tell whether they agree"});
    v("warmup", warmup, {.range = at_least(0), .doc = "transitions of each chain in which the proposal is learnt; they are left out"});
    v("draws", draws, {.range = at_least(1), .doc = "draws of each chain that are kept"});
    v("thin", thin, {.range = at_least(1), .doc = "transitions a kept draw; above 1 it saves space: neighbouring draws of a chain are much alike"});
    v("dispersion", dispersion, {.range = between(0, 100), .doc = "starts are drawn with this many times the deviations of the mode's covariance"});
    v.table("dram", dram, "delayed rejection adaptive Metropolis");
  }
};

/// Where chains begin.
struct SamplerStart {
  Eigen::VectorXd mean;        ///< (d), e.g. the mode
  Eigen::MatrixXd covariance;  ///< (d, d), e.g. Laplace's; the unit matrix when empty
  Eigen::MatrixXd points;  ///< (d, chains), when the caller has starts of its own; else they are drawn about `mean`, dispersion times as wide as `covariance`
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
  ExitStatus status = ExitStatus::failed_numerics;  ///< done, or not_to_be_trusted when a chain has not moved once. Convergence is judged by assess().
  std::string message = "the sampler was not run";
  std::vector<double> acceptance;  ///< (chain) mean over the kept transitions
  std::size_t evaluations = 0;     ///< of the density, warm-up and earlier calls included
  std::size_t transitions = 0;     ///< over the chains, warm-up included
  std::size_t resumed = 0;         ///< of these, from earlier calls
  double wall_s = 0;               ///< of this call [s]
};

struct SamplerResult {
  SamplerSummary summary;
  Draws coordinates;                ///< in the density's own coordinates
  Draws quantities;                 ///< what constrain() makes of them
  std::vector<double> log_density;  ///< (chain, draw)
  std::vector<double> acceptance;   ///< (chain, draw), mean over the draw's transitions
};

/// Runs options.chains chains of options.warmup + options.draws * options.thin transitions. Chain k draws from RandomStream(seed, k) alone: its start, then its
/// transitions. A start is refused and drawn anew, each time nearer to the mean, while the density is zero there.
/// With a journal, every chain is saved each save_every seconds and when it stops; the same call goes on from there and ends with the same draws. The caller
/// removes the journal (remove_journal) once the draws are where they belong. Errors: InputError when the journal is of other settings or the disk is full;
/// NumericsError when no start has a positive density, or the density is NaN somewhere; Interrupted when `stop` became true; whatever the density throws.
[[nodiscard]] SamplerResult run_sampler(const LogDensity& density, const SamplerStart& start, const SamplerOptions& options, const SamplerRun& run);

/// Deletes the journal of a run whose draws are safe; nothing happens when there is none.
void remove_journal(const std::filesystem::path& journal);

}  // namespace calomel
