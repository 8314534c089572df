#pragma once
/// simulate.nc.
#include <filesystem>
#include <vector>

#include "forward/model.hpp"

namespace calomel {

struct Provenance;  // base/provenance.hpp

/// strain(condition, sensor, time) with its coordinates and the unit of the values; without the condition where there is one. Errors: InputError when the file
/// cannot be made.
void write_histories(const std::filesystem::path& path, const ModelShape& shape, const std::vector<double>& strain, const Provenance& provenance);

}  // namespace calomel
