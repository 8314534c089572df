#pragma once
/// Runs of the true model, alone or paired with a finer mesh, placed where the search needs them.
#include "inverse/map_search.hpp"

namespace calomel {

/// Adds runs in rounds and searches anew after each: first at the optimum and at distinct points that the records do not rule out, then at the optimum and
/// where, among draws from its posterior, the refined model is least sure. What the surrogate missed at them is kriged onto it (RefinedModel), what the
/// finer mesh changed makes the MeshError; both go into `current`, on which `search` works. Ends when the optimum has moved by less than options.stable
/// posterior sds, or the runs are spent. `optima` is the search without them and `likelihood` its last; the ones with them are given back.
/// A failed run is left out. Errors: those of `models.add_runs`.
std::vector<Optimum> refine_search(MapSummary& out, MapSearch& search, MapModels& current, const MapModels& models, const Eigen::MatrixXd& design,
                                   std::vector<Optimum> optima, std::optional<Likelihood>& likelihood, std::uint64_t seed, const CalibrationProgress& progress);

/// Fills refinement.mesh_difference, next_halving and sentence: the move of the mode when predictions gain half the difference once more,
/// -C J' L^-1 (-d / 2), J and C the whitened secants and the covariance in the search's coordinates.
void judge_mesh(MapSummary& out, const Problem& problem, const MeshError& mesh, const Likelihood& likelihood, const Eigen::MatrixXd& jacobian,
                const Eigen::MatrixXd& covariance, std::span<const double> history);

}  // namespace calomel
