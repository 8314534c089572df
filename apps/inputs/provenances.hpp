#pragma once
/// What each stage's artefacts come from: the options that it reads and hashes of its inputs. A finished stage is reused when they are the same.
#include <string>

#include "apps/inputs/study_inputs.hpp"

namespace calomel {

struct Provenance;  // base/provenance.hpp

[[nodiscard]] Provenance simulate_provenance(const StudyInputs& inputs);
[[nodiscard]] Provenance floor_provenance(const StudyInputs& inputs);
[[nodiscard]] Provenance campaign_provenance(const StudyInputs& inputs);
/// campaign.nc exists.
[[nodiscard]] Provenance train_provenance(const StudyInputs& inputs);
/// Of runs.journal: the case without the numbers that points of a run may set.
[[nodiscard]] Provenance runs_provenance(const StudyCase& study);
/// The same of another simulator made from the case, such as a planned experiment's.
[[nodiscard]] Provenance runs_provenance(const StudyCase& study, const Simulator& simulator);
/// surrogate.nc exists where the basin is sought on it, and is then an input.
[[nodiscard]] Provenance posterior_provenance(const StudyInputs& inputs);
/// Of sensitivity.json; surrogate.nc exists where it is the surrogate that is analysed.
[[nodiscard]] Provenance sensitivity_provenance(const StudyInputs& inputs, bool by_surrogate);
/// Of diagnosis.json.
[[nodiscard]] Provenance diagnosis_provenance(const StudyInputs& inputs);
/// power.json: the same of what is planned; no recordings.
[[nodiscard]] Provenance power_provenance(const StudyInputs& inputs);
/// Of `method`, "enc", "spe" or "map". Its training data exist: for ENC surrogate.nc, for SPE campaign.nc, and where it takes the posterior's emulator what
/// posterior_provenance requests.
[[nodiscard]] Provenance calibration_provenance(const StudyInputs& inputs, const std::string& method);
/// Of comparison.json, before the methods that it compares.
[[nodiscard]] Provenance comparison_provenance(const StudyInputs& inputs);

/// Whether the first box of the emulator is placed about the best point of surrogate.nc.
[[nodiscard]] bool basin_on_surrogate(const StudyCase& study);

/// Whether `method` takes the posterior's emulator: MAP, and ENC and SPE where they are corrected for the mesh.
[[nodiscard]] bool takes_emulator(const StudyCase& study, const std::string& method);

/// map.compare_with, relative to the folder of the case.
[[nodiscard]] std::filesystem::path nested_directory(const StudyInputs& inputs);

}  // namespace calomel
