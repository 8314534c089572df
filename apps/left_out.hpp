#pragma once
/// What mechanisms that a case does not have would do to its records, by secants of the true model.
#include <span>
#include <vector>

#include "forward/built_in_model.hpp"
#include "inverse/screening.hpp"

namespace calomel {

/// A mechanism each, of those that are built and not enabled in the model's case: secants of the ensemble mean at `theta` by its deciding keys, from a quarter of the way to the
/// lower end of the prior range to a quarter of the way to the upper end, or from the off value where it has no side below. Directions whose runs fail or that
/// the case refuses are left out, and mechanisms that cost more than four times the base model (bubbly_liquid, whose first order tells little besides). Two runs of the model a key, on `threads` threads.
std::vector<LeftOut> left_out_directions(const BuiltInModel& model, std::span<const double> theta, int threads);

}  // namespace calomel
