#pragma once
/// What `calomel sample` walks on where there is an emulator.
#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/predictive_groups.hpp"
#include "uq/drawn_noise_density.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel {

/// The posterior of a fit, averaged over draws of its noise's hyperparameters, or with their estimate alone. `in` and `fit` outlive it.
class SampledEmulator {
 public:
  /// draws: of the hyperparameters; below 2, or where runs carry no noise: the estimate alone.
  SampledEmulator(const PosteriorInputs& in, const PosteriorFit& fit, int draws, std::uint64_t seed, int threads);

  [[nodiscard]] const LogDensity& density() const { return averaged_ ? static_cast<const LogDensity&>(*averaged_) : plain_; }
  /// `hyperparameters` of posterior.json; why_none: if the estimate alone was used on request.
  [[nodiscard]] Json hyperparameters(const SamplerResult& result, const std::string& why_none) const;

 private:
  const PosteriorFit& fit_;
  PosteriorDensity plain_;
  std::vector<DrawnNoise> drawn_;
  std::optional<DrawnNoiseDensity> averaged_;
  bool asked_;
};

/// A posterior under other errors on the same emulator, sampled by chains of its own: `compared` of posterior.json. own: the case's own parameters. Errors:
/// those of compared_posterior and run_sampler.
Json sample_compared(const std::string& form, const PosteriorInputs& in, const PosteriorFit& fit, const std::vector<std::string>& own,
                     const SamplerOptions& options, const SamplerRun& run);

}  // namespace calomel
