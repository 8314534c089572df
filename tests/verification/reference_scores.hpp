#pragma once
/// Comparison of draws with the published reference of a posterior.
#include <filesystem>
#include <string>

#include "tests/verification/reference_posteriors.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel::testing {

/// The file {data, reference} of a posterior: in data/posteriors of the folder `shared` beside the source tree, or of the folder that CALOMEL_SHARED names.
std::filesystem::path reference_path(const ReferencePosterior& posterior);
/// Contents of the file; null if it does not exist.
Json reference_file(const ReferencePosterior& posterior);

struct Scores {
  double worst = 0;         ///< the greatest |z|, with its sign; infinite where all draws lie on one side of a quantile
  std::string where;        ///< "tau at 0.05"
  std::size_t checked = 0;  ///< quantiles
};
/// At the 5, 25, 50, 75 and 95 % quantiles q of the reference, z = (p^ - p) / sqrt(p (1 - p) (1 / ESS + 1e-4)), p^ the share of draws below q, ESS the
/// effective sample size of the indicator x <= q, 1e-4 for the reference's own 10 000 draws.
Scores scores(const Draws& draws, const Json& reference);

/// Mean and covariance of the starts; run_sampler draws starting points about the mean.
SamplerStart start_of(const ReferencePosterior& posterior);

/// Runs the sampler options.kind. A sampler with two densities takes `stand_in` for its first stage; others ignore it.
SamplerResult sample(const LogDensity& density, const LogDensity& stand_in, const SamplerStart& start, const SamplerOptions& options, const SamplerRun& run);

}  // namespace calomel::testing
