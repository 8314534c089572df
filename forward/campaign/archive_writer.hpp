#pragma once
/// campaign.nc from a complete journal.
#include "forward/campaign/archive.hpp"
#include "forward/campaign/journal.hpp"
#include "forward/campaign/repeatability_floor.hpp"

namespace calomel {

struct Provenance;  // base/provenance.hpp

/// Writes campaign.nc, one variable after another so that only one is in memory, and returns message(run), empty where a
/// run is done. theta: (n_parameters, n_runs); `floor` may be null. Values are single precision: 6e-8 of themselves, far below the scatter.
/// Errors: InputError when the disk is full.
std::vector<std::string> write_archive(const std::filesystem::path& path, const ModelShape& shape, const std::string& design, const Eigen::MatrixXd& theta,
                                       const Journal& journal, const RepeatabilityFloor* floor, const Provenance& provenance);

}  // namespace calomel
