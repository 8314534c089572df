#pragma once
/// The posterior of the parameters by Markov chains on the multilevel emulator: posterior.nc and posterior.json.
#include "base/errors.hpp"

namespace calomel {

struct StageCall;

/// Basin, emulator, mode, chains, check by the true model. Chains that were cut off are gone on with.
ExitStatus sample_stage(StageCall& call);

}  // namespace calomel
