#pragma once
/// The posterior of a case's parameters on the multilevel emulator: what the verbs that need it share.
#include <memory>
#include <vector>

#include "apps/pipeline/study_case.hpp"
#include "forward/level_runs.hpp"
#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

/// The meshes and what a fit works on. It refers to itself: made in place, never copied.
struct CasePosterior {
  Recordings records;
  std::unique_ptr<LevelRuns> runs;
  std::unique_ptr<PosteriorInputs> inputs;
  PosteriorFit fit;
};

/// Parameters of the posterior: the case's, with handbook priors for the physical product, and the viscosity where it has a prior and is none of them.
std::vector<Parameter> posterior_parameters(const StudyCase& study, const ModelShape& shape);

/// Element sizes of the emulator's meshes, finest last: those that are set, else the case's own and its half; {0} for a mesh from a file, which has no other.
std::vector<double> element_sizes(const StudyCase& study);

/// (sensors, 3) [m].
Eigen::MatrixXd gauge_positions(const StudyCase& study);

/// errors.mesh or its default, for an emulator with one mesh.
double mesh_error(const StudyCase& study);

}  // namespace calomel
