#pragma once
/// Scores on the finer mesh for a calibration that decides by something else: its histories stay those of the case's mesh until it is done.
#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "inverse/calibration.hpp"
#include "inverse/likelihood/mesh_error.hpp"

namespace calomel {

/// Keeps how each run that is seen scores with the difference to half the element size added, as the pairs of runs tell it, and no further: what other
/// calibrations with pairs are scored on too, so that one table compares like with like.
class FinerScores {
 public:
  /// Both outlive the object; with an empty mesh error it does nothing.
  FinerScores(const Problem& problem, const MeshError& mesh) : problem_(problem), mesh_(mesh) {}
  /// A run on the case's mesh; values: (condition, sensor, time). From any thread.
  void see(std::span<const double> theta, std::span<const double> values);
  /// Turns scores and histories of `out` into those on the finer mesh and keeps their own in out.mesh, with a sentence. Candidates that were not seen lose
  /// their score.
  void put_into(Calibration& out) const;

 private:
  [[nodiscard]] std::vector<double> finer(std::span<const double> theta, std::span<const double> values) const;
  const Problem& problem_;
  const MeshError& mesh_;
  std::mutex lock_;
  std::map<std::vector<double>, Score> scores_;
};

}  // namespace calomel
