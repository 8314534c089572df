#pragma once
/// What a fit says against its own case: slips of whoever wrote the case or wired the gauges, which leave chains and emulator in order.
#include <string>
#include <vector>

#include "inverse/posterior/fit_residual.hpp"
#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

/// One sentence for each: gauges that are dead; gauges that look mixed up; where none does, for all that follows would be their doing, a clock that is off and
/// numbers that the records pull far from what was said of them.
[[nodiscard]] std::vector<std::string> slips(const PosteriorInputs& in, const PosteriorFit& fit);

/// The same of a model that was fitted without an emulator, but for the clock. prediction: (size) on the grid of the errors; left: what it leaves of the
/// records.
[[nodiscard]] std::vector<std::string> slips(const Problem& problem, const ErrorOptions& options, const ErrorModel& errors, const Eigen::VectorXd& prediction,
                                             const FitResidual& left);

}  // namespace calomel
