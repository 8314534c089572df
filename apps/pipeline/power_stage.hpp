#pragma once
/// diagnose --power: what a planned experiment could show.
#include "apps/pipeline/stage_call.hpp"

namespace calomel {

/// Makes records of the base model at its nominal values as `[power]` plans them, fits them, and writes power.json: for each mechanism the strength from which
/// on it could be named, with the case's gauges and with each further gauge and beam power. Needs no recordings. Errors: InputError with its place; those of
/// the runs; Interrupted.
ExitStatus power_stage(StageCall& call);

}  // namespace calomel
