#pragma once
/// Refinement of the emulator where runs of the true model do not agree with it.
#include <functional>
#include <vector>

#include "inverse/posterior/posterior_fit.hpp"
#include "inverse/posterior/true_model_check.hpp"

namespace calomel {

/// One refinement after a check that did not hold.
struct Refinement {
  TrueModelCheck check;
  int runs = 0;             ///< number of runs that the emulator was given: those of the check, those at the posterior's draws, and those of the rounds after
  bool shrank_box = false;  ///< whether its box was shrunk about the mode
};

/// Why no further refinement was made.
enum class RefinementEnd {
  holds,         ///< the check held
  unchecked,     ///< no run of the check came through
  none_allowed,  ///< the case allows none
  limit          ///< as many as the case allows were made
};

/// The last fit, with what led to it.
struct RefinedFit {
  PosteriorFit fit;      ///< the last fit; its rounds are those of all fits
  TrueModelCheck check;  ///< the check of that fit
  std::vector<Refinement> refinements;
  RefinementEnd ended = RefinementEnd::holds;  ///< why no more were made
};

/// Compares the true model with the emulator at draws of short chains from all modes in the box. Where they do not agree, it refines the emulator and fits
/// again, at most `most` times. A refinement adds the runs of the check, and `emulator.round_coarse` and `round_fine` runs at those draws from the posterior
/// where the emulator's variance is greatest. It shrinks the box about the mode where the box is far wider than the posterior, since a polynomial of order two
/// follows the model worse in a wider box. Each fit has its own random streams (in.seed + 100 000 times its number), so that no check repeats points that the
/// emulator was trained on. Runs come from `in.run` alone, so that an interrupted call with a store behind it ends with the same fit. checked: called after
/// each check; round_done: after each round of each fit; either may be empty. Errors: those of fit_posterior.
[[nodiscard]] RefinedFit check_and_refine(const PosteriorInputs& in, PosteriorFit first, int most,
                                          const std::function<void(const TrueModelCheck&)>& checked = {},
                                          const std::function<void(const PosteriorRound&)>& round_done = {});

}  // namespace calomel
