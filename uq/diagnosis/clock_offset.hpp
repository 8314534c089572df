#pragma once
/// An offset of the clock of all records together, which no mechanism explains.
#include <optional>

#include "inverse/data/decimation.hpp"
#include "inverse/data/problem.hpp"
#include "inverse/posterior/posterior_fit.hpp"
#include "uq/diagnosis/first_order.hpp"

namespace calomel {

/// Delay of all records behind the clock of the simulation.
struct ClockOffset {
  double delay = 0, sd = 0;     ///< [s]; early where it is negative
  double log_bayes_factor = 0;  ///< over the base model, to first order
};

/// The effect of a delay of all records by 1 s, -d history / dt on the grid of the fit. Its prior standard deviation is a hundredth of the record's length.
/// history: (values of the model).
[[nodiscard]] AddedDirections clock_directions(const Problem& problem, const Decimation& grid, const Eigen::VectorXd& history);

/// The offset at the mode of a fit, where its log Bayes factor is one that a name would need; else nothing.
[[nodiscard]] std::optional<ClockOffset> clock_offset(const Problem& problem, const PosteriorFit& fit);

}  // namespace calomel
