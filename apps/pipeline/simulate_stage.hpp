#pragma once
/// One run of the case's model, or its ensemble mean: simulate.nc, simulate.json and with --fields fields.exo.
#include "base/errors.hpp"

namespace calomel {

struct StageCall;

/// At the numbers of the case's tables. A single run that was cut off is gone on with. Errors: InputError for --fields with --mean, and for a nominal value
/// that was requested by --set and has no effect.
ExitStatus simulate_stage(StageCall& call);

}  // namespace calomel
