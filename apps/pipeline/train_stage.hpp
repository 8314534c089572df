#pragma once
/// Surrogates trained on the campaign: surrogate.nc and train.json.
#include "apps/pipeline/finished_stages.hpp"
#include "base/errors.hpp"

namespace calomel {

struct StageCall;

/// The status is that of the campaign.
ExitStatus train_stage(StageCall& call, Requested requested = Requested::by_user);

/// surrogate.nc where the basin of the posterior is sought on it: it is then an input of all that takes the posterior's emulator. What is wrong with the
/// emulator's meshes is reported before the work.
void need_basin(StageCall& call);

}  // namespace calomel
