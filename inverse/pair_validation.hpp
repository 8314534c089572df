#pragma once
/// Cross-validation of a calibration by its own pairs: does the search find the parameters of a pair of runs that it does not know, as well as it says?
#include "inverse/map_search.hpp"

namespace calomel {

/// Leaves out each of the pairs nearest to the optimum in turn (half of all pairs, by the optimum's own covariance; at least three), takes its working + (1 + beyond)
/// (finer - working) for the records, and searches from the pair's own place and from `optima`. With e the answer less the pair's parameters and C the search's covariance there,
///
///     inflation = max(1, mean of e' C^-1 e / n over the pairs),
///
/// the factor by which covariances of such answers are too small. Records of a pair have no noise, which C counts, and an answer has a pair of its own, which here is
/// missing: the one makes the factor smaller, the other greater. Nothing is judged with fewer than six pairs. `current` is as before afterwards.
[[nodiscard]] PairValidation validate_pairs(MapSearch& search, MapModels& current, const MapModels& models, const std::vector<AddedRun>& runs,
                                            const std::vector<Optimum>& optima);

}  // namespace calomel
