#pragma once
/// The mesh's error in evolutionary neural calibration: pairs of runs where its searches lead, and the surrogate that they set right.
#include <optional>
#include <utility>

#include "inverse/enc.hpp"
#include "inverse/refined_model.hpp"

namespace calomel {

/// A surrogate, what it missed at the runs that were made, and the mesh's error. Without runs the surrogate itself.
class CorrectedSurrogate {
 public:
  /// `variance`: of (model - surrogate), or none. Models and pairs outlive the object.
  CorrectedSurrogate(const ForwardModel& surrogate, const MeshPairs& pairs, RefinedModel::Variance variance = {})
      : surrogate_(surrogate), pairs_(pairs), variance_(std::move(variance)) {}
  /// Takes in the runs that the pairs have by now; a model() taken before is gone.
  void learn();
  [[nodiscard]] const ForwardModel& model() const;
  /// Of (model - this) by now; nothing where the surrogate's own is not known. Valid until learn() is called.
  [[nodiscard]] RefinedModel::Variance variance() const;

 private:
  const ForwardModel& surrogate_;
  const MeshPairs& pairs_;
  RefinedModel::Variance variance_;
  std::optional<RefinedModel> refined_;
  std::optional<ShiftedModel> shifted_;
};

/// Pairs at the nominal point, at the optimum of a short search without the shift and at good runs of the campaign far from one another; then, as long as
/// pairs are left and the optimum moves, at the best two points of a short search with what is known. Short: a tenth of the rounds, 4 at least.
/// Fills rounds, settled and without of out.mesh. `plan`: of the calibration's own search.
void learn_mesh(EncSummary& out, const Problem& problem, const ForwardModel& surrogate, const Archive& archive, MeshPairs& pairs, CorrectedSurrogate& corrected,
                RoundPlan plan, double separation, std::uint64_t seed, int threads, const CalibrationProgress& progress);

}  // namespace calomel
