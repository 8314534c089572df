#pragma once
/// A finished MAP in another output directory, as a rival of this case's.
#include <filesystem>

#include "inverse/map.hpp"

namespace calomel {

/// Reads map.json, map.nc and, where it stands, added_runs.nc of `directory`. Parameters that it did not seek take their nominal values of `shape`.
/// `recordings`: hash of the records that it must have been fitted to. Errors: InputError when it is not there or not finished, when it is of other
/// records, another product or another length of histories.
[[nodiscard]] RivalFit read_rival_fit(const std::filesystem::path& directory, const ModelShape& shape, const MapOptions& options, const std::string& recordings);

}  // namespace calomel
