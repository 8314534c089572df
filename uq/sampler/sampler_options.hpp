#pragma once
/// The catalogue of samplers, and `[sampler]` of a case file. What other code needs to know of a sampler is a property of its entry here; no other code needs
/// to know for a sampler by its name.
#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/any_options.hpp"
#include "base/registry.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/log_density.hpp"
#include "uq/sampler/markov_chain.hpp"
#include "uq/sampler/start.hpp"

namespace calomel {

struct SamplerOptions;

/// What a chain is made from. All of it outlives the chain.
struct ChainSetting {
  const LogDensity& density;  ///< the density to sample; for a sampler of two densities, the cheap one
  const LogDensity* exact;    ///< for a sampler of two densities, the one to sample; null for all others
  const SamplerOptions& options;
  const StartMode& mode;                ///< the mode about which the chain starts, with the covariance that is known there beforehand
  const std::vector<StartMode>& modes;  ///< all modes that are known
};

/// Transitions of a chain.
struct ChainLengths {
  int warmup = 0;  ///< of the warm-up
  int draws = 0;   ///< draws that are kept
  int thin = 1;    ///< transitions for each kept draw
};

/// One sampler of the catalogue.
struct SamplerEntry {
  /// Makes one chain. Errors: InputError when the covariance is not positive definite or the options do not suit the density.
  std::function<std::unique_ptr<MarkovChain>(const ChainSetting& setting)> chain;
  /// The usual number of evaluations of the sampled density in one transition of one chain, for forecasts. dimension: of the density.
  std::function<double(const SamplerOptions& options, std::size_t dimension)> evaluations;
  ChainLengths lengths;                          ///< defaults of a case that selects this sampler
  std::optional<ChainLengths> external_lengths;  ///< defaults where the case's model is external, if they differ
  AnyOptions options;                            ///< the table `[sampler.NAME]` with its defaults
  bool needs_gradient = false;                   ///< the sampler refuses a density without a gradient
  /// The sampler that proposes on the cheap density, for a sampler of two densities; empty for all others. The case's table of that sampler is then read too,
  /// and that sampler takes over where there is only one density.
  std::string first_stage;
  std::vector<std::string> limits;  ///< keys of the own table that may end a run but change no draw; the identity of a result leaves them out
  /// Checks the options against the number of parameters before any run of the model; may be empty. Errors: InputError.
  std::function<void(const SamplerOptions& options, std::size_t dimension)> check;
  SamplerRemedies remedies;  ///< keys that the user may change when chains have not converged
};

/// All samplers; the first is the default of a case.
const Registry<SamplerEntry>& samplers();

/// The table `[sampler.NAME]` of one sampler.
struct SamplerTable {
  std::string name;
  AnyOptions options;
};
/// The tables of all samplers of a catalogue, with their defaults.
[[nodiscard]] std::vector<SamplerTable> sampler_tables(const Registry<SamplerEntry>& catalogue);

/// `[sampler]` of a case file.
struct SamplerOptions {
  std::string kind = samplers().rows().front().name;
  int chains = 4;
  int warmup = samplers().rows().front().entry.lengths.warmup;
  int draws = samplers().rows().front().entry.lengths.draws;
  int thin = samplers().rows().front().entry.lengths.thin;
  double dispersion = 2;
  std::vector<SamplerTable> tables = sampler_tables(samplers());  ///< one for each sampler of the catalogue, in its order
  const Registry<SamplerEntry>* catalogue = &samplers();          ///< the samplers that `kind` selects from; outlives the options

  template <class V>
  void visit(V& v) {
    v("kind", kind, {.doc = "how chains move", .choices = catalogue->names()});
    v("chains", chains, {.range = between(1, 1000), .doc = "chains, each from a start of its own; four or more show whether they agree"});
    v("warmup", warmup,
      {.range = at_least(0),
       .doc = "transitions of each chain in which the proposal is learnt; they are left out. This default and the next two are " +
              catalogue->rows().front().name + "'s; the other kinds' are in theory/sampling.md"});
    v("draws", draws, {.range = at_least(1), .doc = "draws of each chain that are kept"});
    v("thin", thin, {.range = at_least(1), .doc = "transitions a kept draw; above 1 it saves space: neighbouring draws of a chain are much alike"});
    v("dispersion", dispersion, {.range = between(0, 100), .doc = "starts are drawn with this many times the deviations of the mode's covariance"});
    for (auto& table : tables) v.table(table.name.c_str(), table.options, "");
  }

  /// The entry of `kind`. Errors: InputError for an unknown kind.
  [[nodiscard]] const SamplerEntry& entry() const { return catalogue->get(kind, "sampler.kind"); }
  /// The table whose type is O. Errors: ContractFailure when no sampler of the catalogue has such a table.
  template <class O>
  [[nodiscard]] const O& table() const {
    const O* found = nullptr;
    for (const auto& table : tables)
      if (const O* own = table.options.template as<O>()) found = own;
    expect(found != nullptr, "a sampler of the catalogue has a table of this type");
    return *found;
  }
  template <class O>
  [[nodiscard]] O& table() {
    return const_cast<O&>(std::as_const(*this).template table<O>());
  }
};

/// The defaults of a kind; with `external`, those for a case whose model is external. Errors: InputError for an unknown kind.
[[nodiscard]] SamplerOptions default_sampler_options(const std::string& kind, bool external = false, const Registry<SamplerEntry>& catalogue = samplers());

/// The options of a sampler that samples one density: `options` itself, or for a sampler of two densities the defaults of its first stage.
[[nodiscard]] SamplerOptions one_density_options(const SamplerOptions& options);

/// The options on which the draws depend: tables of other kinds are left out, unless the sampler reads them, and so are the limits of the own table.
[[nodiscard]] Json identity_options(const SamplerOptions& options);

/// The usual number of evaluations of the sampled density in a whole run, docs/theory/sampling.md; a forecast. Densities that are hard to sample take several
/// times as many. Errors: InputError for an unknown kind.
[[nodiscard]] double usual_evaluations(const SamplerOptions& options, std::size_t dimension);

}  // namespace calomel
