#pragma once
/// Sentences about the power of a planned experiment.
#include <string>
#include <vector>

#include "uq/power/power.hpp"

namespace calomel {

/// Of the first plan, a line a number: from which value on it could be named, or that it could not be and why; then what each further gauge or beam power would
/// change, the most useful first.
std::vector<std::string> power_lines(const std::vector<PlanPower>& plans);

}  // namespace calomel
