#pragma once
/// Draws held against a posterior's published reference.
#include <filesystem>
#include <string>

#include "tests/verification/reference_posteriors.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel::testing {

/// Where a posterior's {data, reference} is or would be: data/posteriors of the folder `shared` beside the source tree, or of where CALOMEL_SHARED points.
std::filesystem::path reference_path(const ReferencePosterior& posterior);
/// What the file holds; null where it is not there.
Json reference_file(const ReferencePosterior& posterior);

struct Scores {
  double worst = 0;         ///< the greatest |z|, with its sign; infinite where all draws lie on one side of a quantile
  std::string where;        ///< "tau at 0.05"
  std::size_t checked = 0;  ///< quantiles
};
/// At the 5, 25, 50, 75 and 95 % quantiles q of the reference, z = (p^ - p) / sqrt(p (1 - p) (1 / ESS + 1e-4)), p^ the share of draws below q, ESS the
/// effective sample size of the indicator x <= q, 1e-4 for the reference's own 10 000 draws.
Scores scores(const Draws& draws, const Json& reference);

/// Centre and deviations of the starts; point starts are drawn about it by run_sampler.
SamplerStart start_of(const ReferencePosterior& posterior);

/// The sampler options.kind, whichever it is: one of two densities takes `stand_in` for its first stage, others do not see it.
SamplerResult sample(const LogDensity& density, const LogDensity& stand_in, const SamplerStart& start, const SamplerOptions& options, const SamplerRun& run);

}  // namespace calomel::testing
