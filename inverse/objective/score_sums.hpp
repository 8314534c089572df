#pragma once
/// From sums over the samples of observations to the averages of a BatchScore.
#include "inverse/objective/objective.hpp"
#include "inverse/objective/score_kernel.hpp"

namespace calomel {

/// What the sums of an observation are divided by.
struct ObservedSize {
  double samples = 0, banded = 0;
  double norm = 0;  ///< sum of the squared mean record
};
ObservedSize size_of(const Observation& observation);

/// A BatchScore that is added up observation by observation.
class BatchScoreSum {
 public:
  BatchScoreSum(std::size_t columns, double mae_scale);
  void add(const ObservedSize& size, std::span<const ScoreSums> sums);
  [[nodiscard]] BatchScore averages() &&;

 private:
  BatchScore score_;
  double mae_scale_;
  std::size_t observations_ = 0, with_band_ = 0;
};

}  // namespace calomel
