#pragma once
/// A quick model whose base leaves numbers at values that do nothing: what a line and a model outside have in common.
#include <Eigen/Core>
#include <atomic>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "forward/model.hpp"
#include "forward/parameter_group.hpp"
#include "forward/runs/run_store.hpp"

namespace calomel {

class NumberedModel : public ForwardModel {
 public:
  using ForwardModel::evaluate;
  /// At `theta` with further numbers of the case set, by dotted key. With none it is evaluate(theta), byte for byte.
  /// Errors: InputError for a key that names no number.
  [[nodiscard]] virtual Prediction evaluate(std::span<const double> theta, const std::map<std::string, double>& numbers) const = 0;
};

/// Its runs, kept in a run store.
class NumberedRuns {
 public:
  using Progress = RunStore::Progress;
  /// Both outlive the object.
  NumberedRuns(const NumberedModel& model, RunStore& store) : model_(model), store_(store) {}

  /// Records of the columns of thetas (n_parameters + added, n): the case's parameters, below them further numbers; see LevelRuns::run.
  /// Errors: those of RunStore::run.
  std::vector<RunRecord> run(const Eigen::MatrixXd& thetas, std::span<const AddedParameter> added, int threads, const Progress& progress = {},
                             const std::atomic<bool>* stop = nullptr);

 private:
  const NumberedModel& model_;
  RunStore& store_;
};

}  // namespace calomel
