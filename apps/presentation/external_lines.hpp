#pragma once
/// What is told of a model outside of the program.
#include <string>
#include <vector>

#include "forward/external/external_model.hpp"
#include "inverse/data/problem.hpp"

namespace calomel {

/// `check`. `problem`: null where the case has no recordings.
std::vector<std::string> external_plan_lines(const ExternalModel& model, const Problem* problem);
/// `simulate`; wall [s].
std::string external_simulate_line(const ExternalModel& model, double wall);

}  // namespace calomel
