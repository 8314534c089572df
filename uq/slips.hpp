#pragma once
/// What a fit says against its own case: slips of whoever wrote the case or wired the gauges, which leave chains and emulator in order.
#include <string>
#include <vector>

#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

/// One sentence for each: gauges that look mixed up; where none does, for all that follows would be their doing, a clock that is off and numbers that the
/// records pull far from what was said of them.
[[nodiscard]] std::vector<std::string> slips(const PosteriorInputs& in, const PosteriorFit& fit);

}  // namespace calomel
