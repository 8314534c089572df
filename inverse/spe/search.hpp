#pragma once
/// One round of sparse polynomial expansion calibration: surrogates of the misfit, their optima, the modes of these.
#include "forward/surrogate/feasibility.hpp"
#include "inverse/spe/spe.hpp"

namespace calomel {

/// Fits the surrogates to `data` and warns of those that were left out. Errors: InputError when every coefficient of every surrogate vanishes.
void fit_round(SpeSummary& out, const ScatteredData& data, const SpeOptions& options, std::uint64_t seed, int threads, const CalibrationProgress& progress);

/// Searches every surrogate of `box` from random starts, side by side; each has its own random stream. Optima where runs are likely to fail are left out.
/// Fills optima and modes.
void search_round(SpeSummary& out, const Bounds& box, const Feasibility& feasibility, const SpeOptions& options, std::uint64_t seed, int threads,
                  const CalibrationProgress& progress);

/// Points as proposals with the predictions of the surrogates of `box`, NaN outside of it.
std::vector<Proposal> proposals(const SpeSummary& s, const Bounds& box, const std::string& transform, const std::vector<std::vector<double>>& thetas);

/// The modes, densest first, then the optima, best first.
std::vector<Proposal> ranked_proposals(const SpeSummary& s, const Bounds& box, const std::string& transform);

}  // namespace calomel
