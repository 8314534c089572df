#pragma once
/// What a point calibration took off for its mesh, for its artefacts.
#include <optional>
#include <string>
#include <vector>

#include "inverse/problem.hpp"

namespace calomel {

/// A search with the pairs that were there, and where it ended.
struct MeshRound {
  int pairs = 0;
  std::vector<double> theta;  ///< (n_parameters)
  double moved = 0;           ///< since the round before, the largest over the parameters in units of their bounds
};

/// Pairs of runs, on the case's mesh and on one of half the element size, and what they changed.
struct MeshCorrection {
  int wanted = 0, pairs = 0, failed = 0;  ///< pairs allowed, both runs of which came through, and not
  double beyond = 0;                      ///< BeyondFiner::mean
  std::vector<MeshRound> rounds;
  bool settled = false;                   ///< the last round moved the optimum no further
  double difference = 0;                  ///< |finer - working| / |working| at the answer, mean over the observations
  std::vector<double> without;            ///< the answer without the shift, (n_parameters); docs/theory tells how each method takes it
  std::vector<double> calibrated, nominal_values;  ///< (condition, sensor, time) on the case's mesh, without the shift; empty where failed
  Score best, at_nominal;                          ///< of these
  std::string sentence;
  [[nodiscard]] bool used() const { return pairs >= 2; }
  /// Which mesh the scores beside it are on, in words.
  [[nodiscard]] std::string scores_on() const;
};

}  // namespace calomel
