#pragma once
/// campaign.nc from the runs of a design.
#include <functional>

#include "forward/campaign/archive.hpp"
#include "forward/campaign/repeatability_floor.hpp"
#include "forward/simulation/run_record.hpp"

namespace calomel {

struct Provenance;  // base/provenance.hpp

/// Writes campaign.nc, one variable after another so that only one is in memory, and returns message(run), empty where a
/// run is done. theta: (n_parameters, n_runs); `record` gives the run of each column, as often as it occurs; `floor` may be null. Values are single
/// precision. Errors: InputError when the disk is full.
std::vector<std::string> write_archive(const std::filesystem::path& path, const ModelShape& shape, const std::string& design, const Eigen::MatrixXd& theta,
                                       const std::function<RunRecord(std::size_t run)>& record, const RepeatabilityFloor* floor, const Provenance& provenance);

}  // namespace calomel
