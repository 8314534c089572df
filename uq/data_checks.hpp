#pragma once
/// Data checks: mistakes of the case or of the wiring that a fit shows, although its chains and its emulator are in order.
#include <optional>
#include <string>
#include <vector>

#include "inverse/posterior/fit_residual.hpp"
#include "inverse/posterior/posterior_fit.hpp"
#include "inverse/posterior/prior_deviations.hpp"
#include "uq/diagnosis/clock_offset.hpp"
#include "uq/diagnosis/mislabelled_channels.hpp"

namespace calomel {

struct DataChecks {
  std::vector<std::string> dead;                ///< gauges that record nothing but noise
  std::vector<MislabelledChannel> mislabelled;  ///< mixed-up channels; where there is one, all that follows would be its doing and is left out
  std::optional<ClockOffset> clock;             ///< of all records; only checked with an emulator
  std::vector<PriorDeviation> nuisances;        ///< estimates of all marginalised nuisance parameters
};

/// Checks the records by a fit.
[[nodiscard]] DataChecks check_data(const PosteriorInputs& in, const PosteriorFit& fit);

/// Checks the records by a model that was fitted without an emulator. prediction: (size) on the grid of the errors; left: the residual of the records.
[[nodiscard]] DataChecks check_data(const Problem& problem, const ErrorModel& errors, const Eigen::VectorXd& prediction, const FitResidual& left);

}  // namespace calomel
