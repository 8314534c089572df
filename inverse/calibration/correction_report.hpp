#pragma once
/// Corrections of a calibration for its mesh: the option, and what the correction changed.
#include <string>
#include <vector>

#include "inverse/calibration/scored_mesh.hpp"
#include "inverse/data/problem.hpp"

namespace calomel {

/// The option of ENC and SPE that corrects for the mesh, and the options that it replaced.
template <class V>
void visit_mesh_correction(V& v, bool& mesh_correction) {
  v("mesh_correction", mesh_correction,
    {.doc = "predictions are corrected for the mesh by the emulator, whose runs are those of [emulator]: finest mesh less the case's own; false: bare, as "
            "published"});
  v.renamed("mesh_pairs", "mesh_correction = true | false decides; the runs are those of [emulator]");
  v.renamed("mesh_beyond", "mesh_correction leads to the finest mesh of [emulator]; the error of that mesh is part of the posterior (errors.beyond)");
  v.renamed("draws", "the calibration is a point estimate; `calomel sample` reports how well the records determine the parameters");
}

/// Scores and histories on the case's own mesh, where those of the calibration itself are corrected for it.
struct CorrectionReport {
  bool used = false;
  ScoredMesh scores_on = ScoredMesh::own;          ///< mesh of the scores of the calibration itself
  Eigen::Index runs = 0;                           ///< of the emulator that gives the correction
  double difference = 0;                           ///< |correction| / |history| at the answer, mean over the observations
  std::vector<double> without;                     ///< the answer without the correction, (n_parameters); docs/theory describes how each method obtains it
  std::vector<double> calibrated, nominal_values;  ///< (condition, sensor, time) without the correction; empty where failed
  Score best, at_nominal;                          ///< of these
  std::vector<std::string> reservations;           ///< of the correction
};

}  // namespace calomel
