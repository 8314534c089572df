#include "uq/sampler/sampler.hpp"

namespace calomel {

namespace {

constexpr double particle_moves = 40;  ///< of a particle, over some twenty temperatures

}  // namespace

const Registry<SamplerEntry>& samplers() {
  static const Registry<SamplerEntry> all = [] {
    Registry<SamplerEntry> r("sampler");
    // Name, summary, chain, and what a case has by default: warm-up, draws, thin.
    r.add("dram", "delayed rejection adaptive Metropolis (Haario et al. 2006)",
          {[](const ChainSetting& s) { return dram_chain(s.density, s.options.dram, s.mode.covariance); }, 5000, 10000, 4,
           [](const SamplerOptions&, std::size_t) { return 1.7; }});
    r.add("nuts", "no-U-turn sampler along the gradient of the density (Hoffman and Gelman 2014; Betancourt 2017)",
          {[](const ChainSetting& s) { return nuts_chain(s.density, s.options.nuts, s.mode.covariance, s.options.warmup); }, 1000, 2000, 1,
           [](const SamplerOptions&, std::size_t) { return 7.0; }});
    r.add("ensemble", "walkers by one another's places: stretch moves and differential evolution (Goodman and Weare 2010; ter Braak 2006)",
          {[](const ChainSetting& s) { return ensemble_chain(s.density, s.options.ensemble, s.mode.mean, s.mode.covariance, s.options.dispersion); }, 1000,
           1500, 10, [](const SamplerOptions& o, std::size_t d) { return double(walkers_of(o.ensemble, d)); }});
    r.add("smc", "particles through tempered densities, with the evidence (Del Moral et al. 2006)",
          {[](const ChainSetting& s) {
             return smc_chain(s.density, s.options.smc, s.modes, s.options.dispersion, std::size_t(s.options.draws) * std::size_t(s.options.thin));
           },
           1000, 2000, 1,
           [](const SamplerOptions& o, std::size_t) { return particle_moves * double(o.draws) * o.thin / (double(o.warmup) + double(o.draws) * o.thin); }});
    r.add("delayed_acceptance", "DRAM on the emulator first, the true model second (Christen and Fox 2005)",
          {[](const ChainSetting& s) -> std::unique_ptr<MarkovChain> {
             if (s.exact == nullptr)
               throw InputError({.problem = "needs a cheap density beside the one that is sampled, an emulator of the model, and there is none here",
                                 .key = "sampler.kind",
                                 .value = "\"delayed_acceptance\"",
                                 .suggestion = "take \"dram\""});
             return delayed_acceptance_chain(s.density, *s.exact, s.options.delayed_acceptance, s.options.dram, s.mode.covariance, s.options.warmup);
           },
           500, 300, 1,
           [](const SamplerOptions& o, std::size_t) {
             return (double(o.delayed_acceptance.settle) + double(o.draws) * o.thin) / (double(o.warmup) + double(o.draws) * o.thin);
           }});
    return r;
  }();
  return all;
}

}  // namespace calomel
