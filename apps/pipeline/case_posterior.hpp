#pragma once
/// The posterior of a case's parameters on the multilevel emulator, fitted.
#include <memory>

#include "apps/inputs/nested_fit.hpp"
#include "apps/inputs/study_inputs.hpp"
#include "inverse/calibration/calibration.hpp"
#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

struct CasePosterior {
  std::unique_ptr<PosteriorInputs> inputs;
  PosteriorFit fit;
};

/// Finds the basin, makes runs at the most informative points, and fits. Runs are taken from and kept in runs.journal, and every round is reported. With
/// `nested` its parameters are held in a second posterior on the same emulator. surrogate.nc exists where the basin is sought on it. `inputs` outlives the
/// result. Errors: InputError for recordings or meshes, and naming map.compare_with where `nested` is another model's; those of fit_posterior.
CasePosterior fit_case_posterior(StudyInputs& inputs, const CalibrationProgress& progress, const NestedFit* nested = nullptr);

/// Fitted once for all that is done in one call.
class FittedPosterior {
 public:
  /// `inputs` outlives the object.
  explicit FittedPosterior(StudyInputs& inputs) : inputs_(inputs) {}
  /// Fits at the first call. Errors: as fit_case_posterior.
  const CasePosterior& get(const CalibrationProgress& progress);

 private:
  StudyInputs& inputs_;
  std::unique_ptr<CasePosterior> fitted_;
};

}  // namespace calomel
