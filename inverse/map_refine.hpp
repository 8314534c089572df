#pragma once
/// Runs of the true model, alone or paired with a finer mesh, placed where the search needs them.
#include "inverse/map_search.hpp"

namespace calomel {

/// Adds runs in rounds and searches anew after each: first at the optimum and at distinct points that the records do not rule out, then at the optimum and
/// where, among draws from its posterior, the refined model is least sure. What the surrogate missed at them is kriged onto it (RefinedModel), what the
/// finer mesh changed makes the MeshError; both go into `current`, on which `search` works. Ends when the optimum has moved by less than options.stable
/// posterior sds, or in each of two rounds by less than the roughness of a run accounts for, or the runs are spent. `optima` is the search without them and `likelihood` its last; the ones with them are given back.
/// A failed run is left out. Errors: those of `models.add_runs`.
std::vector<Optimum> refine_search(MapSummary& out, MapSearch& search, MapModels& current, const MapModels& models, const Eigen::MatrixXd& design,
                                   std::vector<Optimum> optima, std::optional<Likelihood>& likelihood, std::uint64_t seed, const CalibrationProgress& progress);

/// What judge_mesh is told of the answer, in the search's coordinates.
struct MeshEvidence {
  const Eigen::MatrixXd& jacobian;         ///< whitened secants (values, n)
  const Eigen::MatrixXd& sharp;            ///< inverse of the curvature (n, n)
  const Eigen::MatrixXd& covariance;       ///< as reported (n, n)
  const Eigen::MatrixXd& mesh_covariance;  ///< what the likelihood's covariance holds of the mesh (values, values)
  std::span<const double> history;         ///< of the answer
};

/// Fills refinement.mesh_difference, next_halving and sentence: the move of the mode when predictions gain half the difference once more,
/// -C J' L^-1 (-d / 2), J and C the whitened secants and the reported covariance. A multiple of d is among what the likelihood marginalises, so that move is
/// small wherever that works; the sentence also tells what share of each parameter's variance is the mesh's, G C_mesh G' with the gain
/// G = (J' J + prior)^-1 J' L^-1, which smaller elements would take away.
void judge_mesh(MapSummary& out, const Problem& problem, const MeshError& mesh, const Likelihood& likelihood, const MeshEvidence& at);

}  // namespace calomel
