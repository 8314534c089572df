#pragma once
/// The campaign: campaign.nc and campaign.json, the repeatability floor at its end.
#include "apps/pipeline/finished_stages.hpp"
#include "base/errors.hpp"

namespace calomel {

struct StageCall;

/// See run_campaign. `upstream` prints nothing about a finished campaign.
ExitStatus campaign_stage(StageCall& call, Requested requested = Requested::by_user);

}  // namespace calomel
