#pragma once
/// Sentences about a fit of the posterior: whether the records contradict it, whether the emulator holds, a nested model, and the warnings of MAP.
#include <string>
#include <vector>

#include "inverse/map/map.hpp"
#include "inverse/posterior/goodness_of_fit.hpp"
#include "inverse/posterior/posterior_fit.hpp"
#include "inverse/posterior/true_model_check.hpp"
#include "uq/refinement.hpp"

namespace calomel {

/// Whether the records contradict the fit, with chi-squared and its p values.
std::string goodness_sentence(const GoodnessOfFit& goodness);
/// Whether the emulator has settled, "settled after 48 coarse and 14 fine runs"; if not, how far the mode moved and the emulator's variance.
std::string settling_text(const Settling& settling);
/// Which products of the parameters the data determine and which they leave free.
std::string identification_sentence(const Identification& identification);
/// Whether the residual points where something that was left out would show; empty where no test counts.
std::string score_test_sentence(const ScoreTests& tests);
/// How far runs of the true model lie from the emulator.
std::string check_sentence(const TrueModelCheck& check);
/// Which of two nested models the records favour.
std::string nested_sentence(const NestedModel& nested);
/// Why no further refinement was made, as the end of a sentence.
std::string refinement_end(RefinementEnd end);

/// The message of a MAP: the log posterior at its mode and whether the fit is adequate, or why no run verifies the mode.
std::string map_message(const MapSummary& summary, const PosteriorFit& fit);
/// What may be wrong with the mode: no run verifies it, the emulator has not settled or does not hold, the fit is not adequate, nuisances or bounds are
/// strained, the records drift. In this order.
std::vector<std::string> map_warnings(const MapSummary& summary, const PosteriorInputs& in, const PosteriorFit& fit);
/// The sentences of map.json.
MapWords map_words(const MapSummary& summary, const PosteriorFit& fit);

}  // namespace calomel
