#pragma once
/// The mode of the posterior of a case: map.nc and map.json.
#include "apps/inputs/nested_fit.hpp"
#include "apps/pipeline/stage_call.hpp"
#include "inverse/map/map.hpp"

namespace calomel {

/// The fit that map.compare_with names; nothing where it names none. Errors: InputError with its place, see read_nested_fit.
std::optional<NestedFit> compared_fit(StudyInputs& inputs);

/// The results of need_basin exist. Errors: those of compared_fit, before any long work, and of fit_case_posterior.
MapSummary map_stage(StageCall& call, const Provenance& provenance, const CalibrationProgress& progress);

}  // namespace calomel
