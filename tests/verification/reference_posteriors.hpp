#pragma once
/// Five posteriors with published reference draws (stan-dev/posteriordb: 10 chains of 1000 nearly independent draws each), written from their published
/// definitions, in unconstrained coordinates with the Jacobians of the transformations and with exact gradients.
#include <memory>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "uq/log_density.hpp"

namespace calomel::testing {

/// Whether ln |dq/dx| of the transformations is in the density, as it must be; `dropped` is a control.
enum class Jacobian { kept, dropped };

struct ReferencePosterior {
  std::string name;            ///< eight_schools
  std::string title;           ///< "eight schools, non-centred"
  std::string file;            ///< of data and reference: {data, reference: {quantity: {quantiles: {"0.05": value}}}}
  std::vector<double> centre;  ///< (d), about which chains start
  double deviation = 1;        ///< typical deviation that a sampler receives, the same for every coordinate
  double dispersion = 2;       ///< deviation of the first walkers of an ensemble: smaller than for chains where some would remain in a lesser mode
  std::unique_ptr<LogDensity> (*make)(const Json& data, Jacobian jacobian);
  /// A cheaper or less accurate density on the same coordinates, for samplers that have a first stage. Sampled by itself it misses the reference.
  std::unique_ptr<LogDensity> (*stand_in)(const Json& data);
};

/// eight_schools, kid_scores, autoregression, mixture, lotka_volterra.
const std::vector<ReferencePosterior>& reference_posteriors();
/// Errors: ContractFailure for another name.
const ReferencePosterior& reference_posterior(const std::string& name);

/// Hare and lynx with `steps` Runge-Kutta steps a year in place of ten.
std::unique_ptr<LogDensity> lotka_volterra(const Json& data, int steps);

}  // namespace calomel::testing
