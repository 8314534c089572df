#include "uq/sampler/delayed_acceptance.hpp"
#include "uq/sampler/dram.hpp"
#include "uq/sampler/ensemble.hpp"
#include "uq/sampler/nuts.hpp"
#include "uq/sampler/sampler_options.hpp"
#include "uq/sampler/smc.hpp"

namespace calomel {

const Registry<SamplerEntry>& samplers() {
  static const Registry<SamplerEntry> all = [] {
    Registry<SamplerEntry> r("sampler");
    r.add("dram", "delayed rejection adaptive Metropolis (Haario et al. 2006)", dram_sampler());
    r.add("nuts", "no-U-turn sampler along the gradient of the density (Hoffman and Gelman 2014; Betancourt 2017)", nuts_sampler());
    r.add("ensemble", "walkers by one another's places: stretch moves and differential evolution (Goodman and Weare 2010; ter Braak 2006)", ensemble_sampler());
    r.add("smc", "particles through tempered densities, with the evidence (Del Moral et al. 2006)", smc_sampler());
    r.add("delayed_acceptance", "DRAM on the emulator first, the true model second (Christen and Fox 2005)", delayed_acceptance_sampler());
    return r;
  }();
  return all;
}

}  // namespace calomel
