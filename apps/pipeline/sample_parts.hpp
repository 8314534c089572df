#pragma once
/// What sampling a posterior on an emulator and sampling a model itself share.
#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/stage_call.hpp"
#include "apps/presentation/stage_progress.hpp"
#include "forward/parameter.hpp"
#include "uq/convergence/assess.hpp"
#include "uq/posterior_file.hpp"
#include "uq/sampler/sampler.hpp"

namespace calomel {

/// A sentence for every parameter whose posterior lies more than two prior standard deviations from its prior's middle.
std::vector<std::string> absorption(const std::vector<Parameter>& parameters, const Convergence& convergence);
/// Of a sampler's draws.
Convergence assessed(const SamplerResult& result, int thin);

/// The status that `sample` ended with, where its artefacts exist: it is reported, and not done again. Errors: see FinishedStages.
std::optional<ExitStatus> finished_sample(StageCall& call, const Provenance& provenance);
/// Chains that save themselves in posterior.journal and report their progress. `progress` is held by reference.
SamplerRun saved_run(StageCall& call, const Provenance& provenance, const CalibrationProgress& progress);
/// posterior.nc and posterior.json; the journal is no longer needed then.
void write_sample(StageCall& call, const std::vector<PosteriorGroup>& groups, const Json& json, const Provenance& provenance);

}  // namespace calomel
