#pragma once
/// What people are told of a line before it is run.
#include <string>
#include <vector>

#include "forward/line/line_model.hpp"
#include "inverse/data/problem.hpp"

namespace calomel {

/// What will be run. `problem`: null without recordings.
std::vector<std::string> line_plan_lines(const LineModel& model, const LineDescription& description, const Problem* problem);

}  // namespace calomel
