#pragma once
/// The posterior of a case's parameters on the multilevel emulator: what the verbs that need it share.
#include <memory>

#include "apps/stages.hpp"
#include "forward/level_runs.hpp"
#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

/// A fit and the runs behind it; the store outlives what refers to it.
struct CasePosterior {
  std::unique_ptr<RunStore> store;
  std::unique_ptr<LevelRuns> runs;
  PosteriorFit fit;
};

/// Parameters of the posterior: the case's, with handbook priors for the physical product, and the viscosity where it has a prior and is none of them.
std::vector<Parameter> posterior_parameters(const StudyCase& study, const ModelShape& shape);

}  // namespace calomel
