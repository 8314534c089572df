#pragma once
/// The artefacts of a diagnosis: diagnosis.json and the histories of diagnosis.nc.
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "uq/diagnosis/diagnosis.hpp"

namespace calomel {

struct Provenance;  // base/provenance.hpp

/// A number of an explanation as a person would write it.
struct NumberText {
  std::string value;  ///< "2.31 ± 0.16 mm"
  std::string off;    ///< its value where the mechanism is left out, "0 mm"
};

/// Words about one entry of the ranking. "none" and "unknown" have reasons alone.
struct ExplanationText {
  std::string why, would_change;              ///< why it is named or not, and what would change that
  std::string plain_name, size, message;      ///< name for a reader, its greatest numbers, how its fit ended
  std::vector<NumberText> numbers;            ///< of Alternative::numbers
  std::map<std::string, std::string> places;  ///< by group: the place as fitted
};

/// Sentences and words of diagnosis.json, which the presentation makes.
struct DiagnosisText {
  std::string reason;                      ///< of the verdict, for the terminal and the log
  std::string finding, next_step;          ///< the verdict in two sentences
  std::string separating_measurement;      ///< what to measure to distinguish the first two
  std::vector<ExplanationText> ranking;    ///< of Verdict::ranking
  std::vector<std::string> skipped;        ///< what was not done
  std::vector<std::string> mislabelled;    ///< of BaseFit::mislabelled
  std::string clock;                       ///< where there is an offset
  std::string base_fit;                    ///< whether its emulator has settled
  std::string missing;                     ///< where terms were screened
  std::vector<std::string> missing_terms;  ///< the value of each

  [[nodiscard]] std::string summary() const { return finding + ' ' + next_step; }
};

/// The contents of diagnosis.json. Errors: a contract failure where `text` is not about `d`.
[[nodiscard]] Json diagnosis_json(const Diagnosis& d, const DiagnosisInputs& in, const DiagnosisText& text, const Provenance& provenance);

/// The explanation whose histories are shown beside the base model's: the one that is named, the first of a class, or, where the cause is unknown, the one that
/// comes nearest. Null where there is none.
[[nodiscard]] const Alternative* shown_explanation(const Diagnosis& d);

/// diagnosis.nc: base, explained, held_out_base, held_out_explained (condition, sensor, time), those of the last three that there are; record_mean, band_low,
/// band_high (condition, sensor, record_time), in the data's unit; attributes `verdict` and `explanation`, the name of the explanation that is shown. Errors:
/// InputError when the file cannot be made.
void write_diagnosis_histories(const Diagnosis& d, const Problem& problem, const Provenance& provenance, const std::filesystem::path& path);

}  // namespace calomel
