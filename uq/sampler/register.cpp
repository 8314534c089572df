#include "uq/sampler/sampler.hpp"

namespace calomel {

const Registry<SamplerEntry>& samplers() {
  static const Registry<SamplerEntry> all = [] {
    Registry<SamplerEntry> r("sampler");
    r.add("dram", "delayed rejection adaptive Metropolis, frozen after warm-up (Haario et al. 2006)",
          [](const LogDensity& density, const SamplerOptions& options, const Eigen::MatrixXd& covariance) {
            return dram_chain(density, options.dram, covariance);
          });
    return r;
  }();
  return all;
}

}  // namespace calomel
