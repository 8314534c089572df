#pragma once
/// Rounds of optimisers on a surrogate, side by side: the search of evolutionary neural calibration and of what it is held against.
#include <functional>
#include <string>
#include <vector>

#include "inverse/objective/batch_scorer.hpp"
#include "inverse/calibration/calibration.hpp"

namespace calomel {

/// Name of the gradient search among the optimisers that a calibration is compared with; it is no population optimiser.
inline const std::string gradient_search = "gradient";

struct EncRound {
  std::string optimizer;
  std::vector<double> theta;  ///< (n_parameters)
  double objective = 0;       ///< on the surrogate, in the objective's own sense; NaN when every point failed
  std::vector<double> trace;  ///< (generations + 1) best objective so far; empty for the gradient search
  std::size_t evaluations = 0;
};

/// What rounds are made of.
struct RoundPlan {
  std::vector<std::string> optimizers;  ///< in each round one of them, drawn at random
  std::size_t rounds = 0;
  int generations = 100, population = 40;
  double cell = 0.03;              ///< of the pool, in units of the bounds
  std::size_t pool = 0;            ///< best distinct points kept of each round
  std::uint64_t first_stream = 0;  ///< rounds use the streams (seed, first_stream + round)
};

struct Rounds {
  std::vector<EncRound> rounds;
  std::vector<Proposal> pool;  ///< best points of the cells that the rounds visited, by round
};

/// `done` is called from any thread, one at a time, after each round. The result depends on the seed alone.
/// Errors: InputError for an unknown optimiser; what the surrogate throws.
Rounds search_rounds(const Problem& problem, const ForwardModel& surrogate, const Objective& objective, const RoundPlan& plan, std::uint64_t seed, int threads,
                     const std::function<void(std::size_t done)>& done = {});

/// A round of the gradient search: from the best of `population` random points L-BFGS on the smoothed objective, whose steps are sharpened
/// three times; bounds are kept by x = low + (high - low) (1 + sin u) / 2. The round ends at the best point by the objective itself.
/// `surrogate` has a gradient; `cost` is that of the objective on it.
EncRound gradient_round(const Problem& problem, const ForwardModel& surrogate, const Objective& objective, const BatchCost& cost, const Bounds& bounds,
                        int population, std::uint64_t seed, std::uint64_t stream);

}  // namespace calomel
