#pragma once
/// Sentences about the point calibrations and their correction for the mesh.
#include <string>
#include <vector>

#include "inverse/posterior/emulator_meshes.hpp"
#include "inverse/enc/enc.hpp"
#include "inverse/map/map.hpp"
#include "inverse/spe/spe.hpp"

namespace calomel {

/// What a value of the product means: tuned or physical.
std::string meaning_sentence(const std::string& product);
/// What the correction for the mesh did; empty without one.
std::string correction_sentence(const Calibration& calibration, const ModelShape& shape);
/// Whether other optimisers and objectives lead to the same answer; empty where none is compared.
std::string agreement_sentence(const EncAgreement& agreement, const ModelShape& shape);

/// The sentences of enc.json and of spe.json.
EncWords enc_words(const EncSummary& summary, const ModelShape& shape);
CalibrationWords calibration_words(const Calibration& calibration, const ModelShape& shape);
/// The objective in the true model, at the best candidate or at the nominal point, or why there is none.
std::string calibration_message(const Calibration& calibration);
/// What may be wrong with the answer of ENC or SPE: no candidate is better than the nominal point or could be run, runs failed, it lies on a bound, the
/// correction for the mesh has reservations or does not reach it. In this order.
std::vector<std::string> calibration_warnings(const Calibration& calibration, const ModelShape& shape);
/// What may be wrong with the surrogates of SPE: spaces that are too large, fits that failed, optima where runs are likely to fail.
std::vector<std::string> surrogate_warnings(const SpeSummary& summary);

/// Lines for the terminal about one method, once its artefacts exist.
std::vector<std::string> enc_lines(const EncWords& words);
std::vector<std::string> spe_lines(const CalibrationWords& words);
std::vector<std::string> map_lines(const MapSummary& summary, const MapWords& words);

/// Why the predictions of `method` are not corrected for the mesh: there is no other. `meshes` is not several.
std::string not_corrected_line(const std::string& method, EmulatorMeshes meshes);
/// A difference of viscosity between the case's mesh and the emulator that the correction does not take off [Pa s].
std::string viscosity_left_sentence(const std::string& method, double of_case, double of_emulator);

}  // namespace calomel
