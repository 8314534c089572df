#include "uq/sampler/sampler.hpp"

namespace calomel {

const Registry<SamplerEntry>& samplers() {
  static const Registry<SamplerEntry> all = [] {
    Registry<SamplerEntry> r("sampler");
    // Name, summary, chain, and what a case has by default: warm-up, draws, thin.
    r.add("dram", "delayed rejection adaptive Metropolis (Haario et al. 2006)",
          {[](const ChainSetting& s) { return dram_chain(s.density, s.options.dram, s.covariance); }, 5000, 10000, 4});
    r.add("nuts", "no-U-turn sampler along the gradient of the density (Hoffman and Gelman 2014; Betancourt 2017)",
          {[](const ChainSetting& s) { return nuts_chain(s.density, s.options.nuts, s.covariance, s.options.warmup); }, 1000, 2000, 1});
    return r;
  }();
  return all;
}

}  // namespace calomel
