#pragma once
/// The meshes on which the scores of a calibration are.

namespace calomel {

/// The mesh on which accuracy and mae of a calibration are.
enum class ScoredMesh { own, emulators_finest };

/// Its name in artefacts, the value of the key scores_on.
[[nodiscard]] constexpr const char* artefact_name(ScoredMesh mesh) {
  return mesh == ScoredMesh::own ? "the case's own mesh" : "the finest mesh of the emulator";
}

}  // namespace calomel
