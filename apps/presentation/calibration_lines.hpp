#pragma once
/// Sentences about the point calibrations and their correction for the mesh.
#include <string>
#include <vector>

#include "inverse/posterior/emulator_meshes.hpp"
#include "inverse/enc/enc.hpp"
#include "inverse/map/map.hpp"
#include "inverse/spe/spe.hpp"

namespace calomel {

/// Lines about one method, once its artefacts exist.
std::vector<std::string> enc_lines(const EncSummary& summary);
std::vector<std::string> spe_lines(const SpeSummary& summary);
std::vector<std::string> map_lines(const MapSummary& summary);

/// Why the predictions of `method` are not corrected for the mesh: there is no other. `meshes` is not several.
std::string not_corrected_line(const std::string& method, EmulatorMeshes meshes);
/// A difference of viscosity between the case's mesh and the emulator that the correction does not take off [Pa s].
std::string viscosity_left_sentence(const std::string& method, double of_case, double of_emulator);

}  // namespace calomel
