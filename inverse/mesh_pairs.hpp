#pragma once
/// Where MAP has its runs of the true model made, on the case's mesh and in pairs with a finer one.
#include <functional>
#include <vector>

#include "forward/campaign/added_runs.hpp"
#include "inverse/calibration.hpp"

namespace calomel {

struct RunSource {
  /// Runs points (n_parameters, n), those on the finer mesh too where `with_fine` says so (n); see AddedRuns::run. Empty: none can be made so.
  std::function<std::vector<AddedRun>(const Eigen::MatrixXd& thetas, const std::vector<bool>& with_fine)> run;
  bool has_finer = false;
};

/// The values of a run's history, as a vector.
inline Eigen::VectorXd values_of(const std::vector<float>& history) { return Eigen::Map<const Eigen::VectorXf>(history.data(), Eigen::Index(history.size())).cast<double>(); }

}  // namespace calomel
