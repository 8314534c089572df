#pragma once
/// What a diagnosis asks of a line: its mechanisms as groups of numbers.
#include <vector>

#include "forward/line/line_model.hpp"
#include "forward/parameter_group.hpp"

namespace calomel {

/// The mechanisms that the line offers (LineModel::offered). The response of one station alone is a group like any other; of several, one acts on each of them
/// alone.
[[nodiscard]] std::vector<ParameterGroup> offered_groups(const LineModel& model);

}  // namespace calomel
