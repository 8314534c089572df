#pragma once
/// The inner loop of BatchScorer, compiled for several instruction sets.
#include <cstddef>

#include "base/instruction_set.hpp"

namespace calomel {

/// Samples come in panels of so many rows, the last of an observation filled with rows that add nothing (all zeros).
inline constexpr std::ptrdiff_t panel_rows = 32;

/// Floats of scratch that a column needs: five sums of the widest vectors.
inline constexpr std::ptrdiff_t score_scratch = 80;

/// Consecutive panels of one observation. The residual of row i and column c is d = offset_i + sum_k directions_ik coefficients_kc.
struct ScorePanels {
  std::ptrdiff_t panels, rank;
  const float* directions;  ///< (panels, rank, panel_rows)
  const float* rows;        ///< (panels, 4, panel_rows): offset; low and high end of the band less the mean record; 1 / (high - low), 0 where there is no band
};

/// Sums of one column over the rows of an observation.
struct ScoreSums {
  float absolute, squares;  ///< of |d|, d^2
  float inside;             ///< number of rows with low < d < high
  float over, under;        ///< largest (d - high) / (high - low) and (low - d) / (high - low), at least 0
};

struct ScoreKernel {
  std::ptrdiff_t most;  ///< columns of a tile that the registers hold
  /// coefficients: for tiles of `most` columns, the last of fewer, (tile, rank, columns of the tile); sums: (columns). scratch: (columns, score_scratch).
  void (*score)(const ScorePanels& panels, const float* coefficients, std::ptrdiff_t columns, ScoreSums* sums, float* scratch);
};

/// For an instruction set that this processor has.
const ScoreKernel& score_kernel(InstructionSet isa);

}  // namespace calomel
