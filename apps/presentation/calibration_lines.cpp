#include "apps/presentation/calibration_lines.hpp"

#include <fmt/format.h>

#include "apps/presentation/fit_words.hpp"
#include "apps/presentation/run_lines.hpp"

namespace calomel {

namespace {

/// "METHOD: SENTENCE" for sentences that are not empty.
std::vector<std::string> of_method(const std::string& method, std::span<const std::string> sentences) {
  std::vector<std::string> lines;
  for (const auto& s : sentences)
    if (!s.empty()) lines.push_back(stage_line(method, s));
  return lines;
}

}  // namespace

std::vector<std::string> enc_lines(const EncSummary& summary) { return of_method("enc", std::vector{summary.mesh.sentence, summary.agreement.sentence}); }

std::vector<std::string> spe_lines(const SpeSummary& summary) { return of_method("spe", std::vector{summary.mesh.sentence}); }

std::vector<std::string> map_lines(const MapSummary& summary) {
  std::vector<std::string> sentences;
  if (summary.status != CalibrationStatus::no_candidate) sentences.push_back(summary.identification.sentence);
  sentences.push_back(check_sentence(summary.check));
  if (summary.score_tests) sentences.push_back(summary.score_tests->sentence);
  if (summary.nested) sentences.push_back(nested_sentence(*summary.nested));
  return of_method("map", sentences);
}

std::string not_corrected_line(const std::string& method, EmulatorMeshes meshes) {
  const std::string why = meshes == EmulatorMeshes::from_file ? "the mesh comes from a file, of which the program makes no finer one"
                                                              : "the emulator has one mesh only (emulator.element_sizes)";
  return stage_line(method, "predictions are not corrected for the mesh: " + why);
}

std::string viscosity_left_sentence(const std::string& method, double of_case, double of_emulator) {
  return stage_line(method, fmt::format("the case's mesh has a regularising viscosity of {:.4g} Pa s, the emulator one of {:.4g}, and emulator.viscosity_sd = "
                                        "0: the difference is not taken off",
                                        of_case, of_emulator));
}

}  // namespace calomel
