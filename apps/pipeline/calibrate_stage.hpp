#pragma once
/// The point calibrations, METHOD.nc and METHOD.json, and comparison.json.
#include <string>
#include <vector>

#include "base/errors.hpp"

namespace calomel {

struct StageCall;

/// Each of `methods` once, "all" standing for every one; where two or more then stand, comparison.json, whose tables are said.
ExitStatus calibrate_stage(StageCall& call, const std::vector<std::string>& methods);

}  // namespace calomel
