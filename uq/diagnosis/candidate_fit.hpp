#pragma once
/// A fit of the base model with the numbers of one group, or of two, beside its own parameters, on an emulator and in a box of its own.
#include <functional>
#include <optional>
#include <vector>

#include "forward/parameter_group.hpp"
#include "inverse/posterior/posterior_fit.hpp"
#include "uq/diagnosis/screening.hpp"
#include "uq/diagnosis/verdict.hpp"

namespace calomel {

struct CandidatePlan {
  std::vector<AddedParameter> added;  ///< numbers and shapes of the candidate
  PosteriorInputs inputs;             ///< of its fit
};

/// Plans the fit of a candidate of `group` on top of `fit`, which was made with `inputs`. The first box reaches from the first-order estimate back to the
/// handbook. The runs of `fit` are known there, with the numbers off. `run` and `gauge_places` are those of `inputs`.
[[nodiscard]] CandidatePlan plan_candidate(const PosteriorInputs& inputs, const PosteriorFit& fit, const ParameterGroup& group,
                                           const ScreenedCandidate& screened);

/// Number of runs that the fit begins with, on all meshes.
[[nodiscard]] int first_runs(const CandidatePlan& plan);

/// Log Bayes factor of a fit over the base model's. It is computed with both under the errors of the one fit and with both under those of the other; the lesser
/// one counts. Errors: NumericsError where no mode is found.
[[nodiscard]] double log_bayes_factor(const PosteriorFit& fit, const PosteriorFit& base);

/// Evidence of the posterior's hypotheses of each scale of a discrepancy, each by itself at the mode near m, over the whole's at m, plus `plus`; -infinity
/// where no mode is found.
[[nodiscard]] EvidenceByScale evidence_by_scale(const LogPosterior& posterior, const LocalMode& m, const std::vector<WeightedErrors>& hypotheses,
                                                double plus = 0);

struct CandidateFit {
  PosteriorInputs inputs;  ///< of its last box
  PosteriorFit fit;
  bool stable = false;  ///< its evidence and its numbers remained while runs were added, or its emulator settled
};

/// Fits over the planned box and, while `wanted`, in a narrower box about the answer until more runs would not change it. `wanted` gets the log Bayes factor so
/// far, and nothing where the emulator is far noisier than the base model's, whose evidence then means little. A box that shrinks is
/// started from several places, of which the best counts. With BoxStrategy::Kind::least_squares the model itself is fitted first, by least squares from several
/// starts, and the box is placed about the best. `round_done` is called after every round of every fit. Errors: those of fit_posterior.
[[nodiscard]] CandidateFit fit_candidate(CandidatePlan plan, const PosteriorFit& base,
                                         const std::function<bool(std::optional<double> log_bayes_factor)>& wanted,
                                         const std::function<void(const PosteriorRound&)>& round_done = {});

}  // namespace calomel
