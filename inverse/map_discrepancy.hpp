#pragma once
/// The discrepancy of the physical product: its scale, and what summing over the scales does to the answer.
#include "inverse/map.hpp"
#include "inverse/map_search.hpp"

namespace calomel {

/// `plain` with a discrepancy of this scale, s^2 A_i A_j k(t_i - t_j) as in discrepancy_shape.
Likelihood with_discrepancy(const Likelihood& plain, const Problem& problem, const MapModels& models, const DiscrepancyOptions& options, double scale);

/// The discrepancy's scale by its posterior weight on a grid: half-normal prior times Laplace evidence. Puts the scale, the weights and scale_spread, what
/// the mixture over the scales adds to the covariance, into `out`, the mode at the best scale into optima[0]; the likelihood with it is given back.
Likelihood choose_discrepancy(MapSummary& out, MapSearch& search, const Problem& problem, const Likelihood& plain, const MapModels& models,
                              const MapOptions& options, std::vector<Optimum>& optima);

}  // namespace calomel
