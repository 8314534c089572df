#include "uq/diagnosis/base_fit.hpp"

#include <algorithm>
#include <limits>

#include "base/log_sum.hpp"
#include "inverse/posterior/multistart_least_squares.hpp"
#include "uq/diagnosis/candidate_fit.hpp"
#include "uq/diagnosis/fit_measures.hpp"
#include "uq/diagnosis/reported_moments.hpp"

namespace calomel {

namespace {

void describe_mode(const DiagnosisInputs& in, BaseFit& base) {
  const LocalMode& m = base.mode();
  const LogPosterior& posterior = *base.fit.posterior;
  base.parameters = own_parameters(in, posterior, reported_moments(base.fit, in.base.seed));
  base.prior_deviations = prior_deviations(in, m.at.theta);
  base.history = kept(base.fit.history_at_mode());
  BaseEvidence& e = base.evidence;
  e.values = double(base.grid().size());
  e.chi2 = plain_chi2(plain_errors(base.fit, posterior, m, *base.fit.errors), *base.fit.errors, base.fit, m);
  e.base_prior_deviation = root_mean_square(base.prior_deviations);
  e.misfit = misfit_of_history(base.fit, values_of(base.history));
  e.by_scale = evidence_by_scale(posterior, m, base.fit.hypotheses);
}

/// Adds the evidence of a discrepancy in one place alone, the mean over all places, and the likeliest place.
void describe_places(const DiagnosisInputs& in, BaseFit& base) {
  const auto places = places_of_discrepancy(in.base.problem, in.base.places.positions);
  if (!(in.base.errors.discrepancy > 0) || places.empty()) return;
  const LocalMode& m = base.mode();
  const double whole = log_evidence(*base.fit.posterior, m);
  std::vector<double> over_whole;
  for (const auto& place : places) {
    const auto errors = with_local_discrepancy(*base.fit.errors, in.base.problem, in.base.errors, in.base.places.positions, place);
    const LogPosterior local = base.fit.under(errors);
    const auto modes = find_modes(local, {local.q(m.at.theta, m.at.beyond)});
    over_whole.push_back(modes.empty() ? -std::numeric_limits<double>::infinity() : log_evidence(local, modes[0]) - whole);
    if (over_whole.back() < *std::max_element(over_whole.begin(), over_whole.end())) continue;
    base.likeliest_place.clear();
    for (const std::size_t s : place) base.likeliest_place.push_back(in.base.problem.shape.sensors[s]);
  }
  base.evidence.local = log_mean(over_whole);
  in.say(LocalEvidenceFound{*base.evidence.local});
}

}  // namespace

BaseFit fit_base(const DiagnosisInputs& in, RunBudget& budget) {
  in.say(BaseFitBegins{});
  PosteriorInputs inputs = in.base;
  inputs.run = [&budget](const Eigen::MatrixXd& thetas, const std::vector<int>& level) { return budget.run(thetas, level, {}); };
  const FitWatch watch{.round_done =
                           [&in](const PosteriorRound& r) {
                             if (in.round) in.round(r, in.base.parameters);
                           },
                       .go_on = [&in](const PosteriorFit& f) { return !surely_mislabelled(in.base.problem, f); }};
  BaseFit base{.fit = fit_posterior(inputs, watch)};
  if (inputs.box.by_least_squares()) base.fit = held_to_the_model(inputs, std::move(base.fit));
  if (inputs.gauge_places) base.place_changes = inputs.gauge_places(base.mode().at.theta);
  describe_mode(in, base);
  describe_places(in, base);
  base.mislabelled = mislabelled_channels(in.base.problem, base.fit);
  if (!base.mislabelled.empty()) budget.skip({.kind = SkippedStep::Kind::mechanisms});
  for (const auto& channel : base.mislabelled) in.say(channel);
  return base;
}

}  // namespace calomel
