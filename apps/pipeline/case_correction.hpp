#pragma once
/// The correction for the mesh that ENC and SPE take from the posterior's emulator.
#include <optional>
#include <string>

#include "apps/pipeline/case_posterior.hpp"
#include "forward/emulator/mesh_correction.hpp"

namespace calomel {

/// Errors: InputError naming emulator.element_sizes when the case's own mesh is none of the emulator's, so that `method` cannot be corrected for it.
void expect_own_mesh_among_emulators(const StudyCase& study, const std::string& method);

/// Taught once for all methods of one call, by the posterior's runs.
class FittedCorrection {
 public:
  /// Both outlive the object.
  FittedCorrection(StudyInputs& inputs, FittedPosterior& posterior) : inputs_(inputs), posterior_(posterior) {}

  /// Finest mesh of the emulator less the case's own. Null when it is not `wanted` or, saying so in a line, when the emulator has no other mesh.
  /// Errors: as expect_own_mesh_among_emulators and fit_case_posterior.
  const MeshCorrection* get(const std::string& method, bool wanted, const CalibrationProgress& progress);

 private:
  StudyInputs& inputs_;
  FittedPosterior& posterior_;
  std::optional<MeshCorrection> correction_;
};

}  // namespace calomel
