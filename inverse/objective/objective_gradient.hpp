#pragma once
/// Slopes of the objectives by the model's values, for gradient searches on surrogates.
#include <span>
#include <vector>

#include "inverse/objective/objective.hpp"

namespace calomel {

struct ObjectiveGradient {
  double cost = 0;              ///< of the smoothed objective, smaller is better
  std::vector<double> weights;  ///< its gradient by the model's values, (shape.values())
};

/// Accuracy counts samples and has no gradient: each counted sample is smoothed to s((y - low) / h) s((high - y) / h) with s(z) = 1 / (1 + exp(-z)) and
/// h = `width` times its band's width; width -> 0 gives the count. The other averages are taken as they are, with a subgradient at their kinks.
/// values: (shape.values()), finite.
[[nodiscard]] ObjectiveGradient objective_gradient(const Problem& problem, const Objective& objective, std::span<const double> values, double width);

}  // namespace calomel
