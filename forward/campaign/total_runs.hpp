#pragma once
/// Dissipated energy and time at cutoff at many points.
#include <Eigen/Core>

#include "forward/simulation/runs.hpp"

namespace calomel {

/// The totals of runs at the columns of thetas (n_parameters, n): (conditions x run_total_count, n), a condition's totals one after another, NaN columns where
/// a run failed. Errors: as Runs::get.
[[nodiscard]] Eigen::MatrixXd totals_at(Runs& runs, const Eigen::MatrixXd& thetas, const Runs::Progress& progress = {});

}  // namespace calomel
