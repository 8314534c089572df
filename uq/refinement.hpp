#pragma once
/// Teaching the emulator anew where runs of the true model do not lie where it says.
#include <functional>
#include <string>
#include <vector>

#include "inverse/posterior/posterior_fit.hpp"
#include "inverse/posterior/true_model_check.hpp"

namespace calomel {

/// A check that did not hold, and what was done.
struct Refinement {
  TrueModelCheck check;
  int runs = 0;          ///< that the emulator was given: those of the check, at the posterior's draws, and of the rounds that followed
  bool drew_in = false;  ///< its box, about the mode
};

struct RefinedFit {
  PosteriorFit fit;      ///< the last one; its rounds are all of them
  TrueModelCheck check;  ///< of that fit
  std::vector<Refinement> refinements;
  std::string ended;  ///< why no more were made, as the end of a sentence
};

/// Holds the true model against the emulator, at draws of short chains from all modes in the box; where it does not lie there, adds the runs of the check and
/// `emulator.round_coarse` and `round_fine` runs at draws from the posterior (where the emulator's variance is greatest among them), draws the box in about the
/// mode where it is far wider than the posterior, since a polynomial of order two follows less the wider it is, and fits anew, `most` times at most. Each fit
/// has streams of its own (in.seed + 100 000 times its number), so that no check repeats points that the emulator was taught by. Runs come from `in.run` alone:
/// with a store behind it a call that was cut off ends with the same fit. told: after each check, may be empty. Errors: those of fit_posterior.
[[nodiscard]] RefinedFit check_and_refine(const PosteriorInputs& in, PosteriorFit first, int most, const std::function<void(const TrueModelCheck&)>& told = {});

}  // namespace calomel
