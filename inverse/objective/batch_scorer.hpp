#pragma once
/// Costs of many points at once on models that are an offset plus fixed directions.
#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "base/instruction_set.hpp"
#include "inverse/objective/objective.hpp"
#include "inverse/objective/score_sums.hpp"

namespace calomel {

/// Sixteen floats on a boundary of the widest vectors.
struct alignas(64) AlignedLine {
  float x[16] = {};
};

/// Scores of offset + directions * coefficients against the recordings, in single precision. What is compared of the directions (their values at the
/// record times, less those with no record) is taken once; residuals then live in registers, tile by tile, and no history is written.
class BatchScorer {
 public:
  /// `basis`: not empty, of the problem's values. The object keeps nothing of either.
  BatchScorer(const Problem& problem, const HistoryBasis& basis, InstructionSet isa = instruction_set());
  /// coefficients: (n_directions, n). The same as score_batch of the histories, but for rounding; NaN for a column with a NaN.
  [[nodiscard]] BatchScore score(const Eigen::MatrixXf& coefficients) const;
  /// Additions and multiplications a column in the product of directions and coefficients.
  [[nodiscard]] double product_operations() const;

 private:
  struct Observed {
    std::ptrdiff_t first = 0, panels = 0;  ///< of the panels of all observations
    ObservedSize size;
  };
  InstructionSet isa_;
  std::ptrdiff_t rank_;
  double mae_scale_;
  std::vector<Observed> observed_;
  std::vector<AlignedLine> directions_, rows_;  ///< as ScorePanels
};

/// The cost of an objective on a model, for many points at once: by a BatchScorer where the model has a basis, else of its histories.
class BatchCost {
 public:
  /// All outlive the object.
  BatchCost(const Problem& problem, const ForwardModel& model, const Objective& objective);
  /// points: (n_parameters, n); result: (n), +infinity for a failed run. Safe to call from several threads at once.
  [[nodiscard]] std::vector<double> operator()(const Eigen::MatrixXd& points) const;

 private:
  const Problem& problem_;
  const ForwardModel& model_;
  const Objective& objective_;
  std::optional<BatchScorer> scorer_;
};

}  // namespace calomel
