#pragma once
/// What a diagnosis asks of a line: its mechanisms as groups of numbers, and runs with them, kept in the run store.
#include <Eigen/Core>
#include <atomic>
#include <span>
#include <vector>

#include "forward/line/line_model.hpp"
#include "forward/parameter_group.hpp"
#include "forward/runs/run_store.hpp"

namespace calomel {

/// The mechanisms that the line offers (LineModel::offered). The response of one station alone is a group like any other; of several, one acts on each of them alone.
[[nodiscard]] std::vector<ParameterGroup> offered_groups(const LineModel& model);

class LineRuns {
 public:
  /// Both outlive the object.
  LineRuns(const LineModel& model, RunStore& store) : model_(model), store_(store) {}

  /// Records of the columns of thetas (n_parameters + added, n): the case's parameters, below them further numbers; see LevelRuns::run.
  /// Errors: those of RunStore::run.
  std::vector<RunRecord> run(const Eigen::MatrixXd& thetas, std::span<const AddedParameter> added, int threads, const RunStore::Progress& progress = {},
                             const std::atomic<bool>* stop = nullptr);

 private:
  const LineModel& model_;
  RunStore& store_;
};

}  // namespace calomel
