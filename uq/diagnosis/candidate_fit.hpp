#pragma once
/// A fit of the base model with the numbers of one or two groups beside its own parameters, on an emulator and in a box of its own.
#include <functional>
#include <optional>
#include <vector>

#include "forward/parameter_group.hpp"
#include "inverse/posterior/posterior_fit.hpp"
#include "uq/diagnosis/question.hpp"
#include "uq/diagnosis/verdict.hpp"

namespace calomel {

struct CandidatePlan {
  std::vector<AddedParameter> added;  ///< by this question
  PosteriorInputs inputs;             ///< of its fit
};

/// A fit of the base model, or of one with numbers of its own, to which the numbers of a question are added. The first box reaches from what the answer says to
/// first order back to the handbook; the runs of `fit` are known there, with the numbers off. `run`, `gauge_places` and `round_done` are those of `inputs`;
/// `go_on` is empty.
[[nodiscard]] CandidatePlan plan_candidate(const PosteriorInputs& inputs, const PosteriorFit& fit, const std::vector<ParameterGroup>& groups,
                                           const Question& question);

/// Runs that it begins with, on all meshes.
[[nodiscard]] int first_runs(const CandidatePlan& plan);

/// Log Bayes factor of a fit over the base model's: both under the errors of the one and both under those of the other; what counts is the lesser. Errors:
/// NumericsError where no mode is found.
[[nodiscard]] double log_bayes_factor(const PosteriorFit& fit, const PosteriorFit& base);

/// Evidence of the posterior's hypotheses of each scale of a discrepancy, each by itself, at the mode near m, over the whole's at m and `plus` more; -infinity
/// where no mode is found.
[[nodiscard]] EvidenceByScale evidence_by_scale(const LogPosterior& posterior, const LocalMode& m, const std::vector<WeightedErrors>& hypotheses,
                                                double plus = 0);

struct FittedCandidate {
  PosteriorInputs inputs;  ///< of its last box
  PosteriorFit fit;
  bool stands = false;  ///< its evidence and its numbers stayed while runs were added, or its emulator settled
};

/// Fits over the planned box and, if `worth` that, in a narrower one about the answer until more runs would not change it; `worth` is asked with its log Bayes
/// factor, and without one where its emulator is far noisier than the base model's, which then says little. A cheap model (`draw_in`) is fitted from several
/// boxes, the best counts; with `least_squares` it is fitted itself first, by least squares from several starts, and the box laid about the best. Errors: those
/// of fit_posterior.
[[nodiscard]] FittedCandidate fit_candidate(CandidatePlan plan, const PosteriorFit& base,
                                            const std::function<bool(std::optional<double> log_bayes_factor)>& worth);

}  // namespace calomel
