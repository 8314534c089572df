#pragma once
/// The point calibrations, METHOD.nc and METHOD.json, and comparison.json.
#include <string>
#include <vector>

#include "base/errors.hpp"

namespace calomel {

struct StageCall;

/// Runs each of `methods` once ("all" means every method); with two or more results also writes comparison.json and prints its tables.
ExitStatus calibrate_stage(StageCall& call, const std::vector<std::string>& methods);

}  // namespace calomel
