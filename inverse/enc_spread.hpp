#pragma once
/// Standard deviations of evolutionary neural calibration: its search and its decision on drawn records.
#include "inverse/drawn_errors.hpp"
#include "inverse/enc.hpp"

namespace calomel {

/// For each of options.draws records: the objective is sought on `surrogate` (with the mesh's shift) in a box about the answer, which grows and moves on where
/// its end is hit; of the best points, a candidate's distance apart, and the nominal one the best by the surrogate with each run's own error wins. Fills
/// out.spread; an error of the likelihood is told there. `likelihood`: of the correlated objective.
void spread_enc(EncSummary& out, const Problem& problem, const ForwardModel& surrogate, const std::function<AnswerErrors()>& errors, const EncOptions& options,
                const Likelihood* likelihood, std::uint64_t seed, int threads, const CalibrationProgress& progress);

}  // namespace calomel
