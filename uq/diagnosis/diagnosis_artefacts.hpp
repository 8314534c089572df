#pragma once
/// What a diagnosis leaves: diagnosis.json (diagnosis_json in diagnosis.hpp) and the histories of diagnosis.nc.
#include <filesystem>

#include "uq/diagnosis/diagnosis.hpp"

namespace calomel {

/// The explanation whose histories are shown beside the base model's: the one that is named, the first of a class, or, where it is not known what is missing,
/// the one that comes nearest. Null where there is none.
[[nodiscard]] const Alternative* shown_explanation(const Diagnosis& d);

/// diagnosis.nc: base, explained, held_out_base, held_out_explained (condition, sensor, time), those of the last three that there are; record_mean, band_low,
/// band_high (condition, sensor, record_time), in the data's unit; attributes `verdict` and `explanation`, the name of the explanation that is shown. Errors:
/// InputError when the file cannot be made.
void write_diagnosis_histories(const Diagnosis& d, const Problem& problem, const Provenance& provenance, const std::filesystem::path& path);

}  // namespace calomel
