#include "tests/verification/reference_scores.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "uq/convergence/diagnostics.hpp"

namespace calomel::testing {

std::filesystem::path reference_path(const ReferencePosterior& posterior) {
  const char* named = std::getenv("CALOMEL_SHARED");
  const auto shared = named ? std::filesystem::path(named) : std::filesystem::path(CALOMEL_SOURCE_DIR).parent_path() / "shared";
  return shared / "data" / "posteriors" / posterior.file;
}

Json reference_file(const ReferencePosterior& posterior) {
  const auto path = reference_path(posterior);
  return std::filesystem::exists(path) ? read_json(path) : Json();
}

Scores scores(const Draws& draws, const Json& reference) {
  Scores s;
  for (const auto& [name, r] : reference.items()) {
    const auto k = std::size_t(std::ranges::find(draws.names, name) - draws.names.begin());
    expect(k < draws.names.size(), "every quantity of the reference has draws");
    const auto x = draws.of(k);
    for (const auto& [text, value] : r["quantiles"].items()) {
      const double p = std::stod(text), q = value.get<double>(), n = double(x.size());
      const double below = double(std::ranges::count_if(x, [q](double v) { return v <= q; })) / n;
      double z = (below - p) / std::sqrt(p * (1 - p) * (1 / ess_indicator({.values = x, .chains = draws.chains, .walkers = draws.walkers}, q) + 1e-4));
      if (std::isnan(z)) z = std::copysign(std::numeric_limits<double>::infinity(), below - p);  // all draws on one side
      ++s.checked;
      if (std::abs(z) > std::abs(s.worst)) s.worst = z, s.where = name + " at " + text;
    }
  }
  return s;
}

SamplerStart start_of(const ReferencePosterior& posterior) {
  const auto d = Eigen::Index(posterior.centre.size());
  return {.mean = Eigen::Map<const Eigen::VectorXd>(posterior.centre.data(), d),
          .covariance = posterior.deviation * posterior.deviation * Eigen::MatrixXd::Identity(d, d),
          .points = {}};
}

SamplerResult sample(const LogDensity& density, const LogDensity& stand_in, const SamplerStart& start, const SamplerOptions& options, const SamplerRun& run) {
  if (!options.entry().first_stage.empty()) return run_sampler(stand_in, density, start, options, run);
  return run_sampler(density, start, options, run);
}

}  // namespace calomel::testing
