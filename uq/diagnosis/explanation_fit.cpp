#include "uq/diagnosis/explanation_fit.hpp"

#include <algorithm>
#include <string>

#include "uq/diagnosis/candidate_fit.hpp"
#include "uq/diagnosis/fit_measures.hpp"
#include "uq/diagnosis/reported_moments.hpp"

namespace calomel {

namespace {

/// The fit that an explanation is added to.
struct Below {
  const PosteriorInputs& inputs;
  const PosteriorFit& fit;
  std::vector<AddedParameter> added;  ///< numbers that the fit has beside the base model's parameters
};

Below below_of(const FitContext& context, const Alternative* on_top_of) {
  if (!on_top_of) return {context.in.base, context.base.fit, {}};
  const ExplanationFit& f = context.library.fits.at(on_top_of->explanation.name);
  return {f.inputs, f.fit, f.added};
}

/// Describes an explanation by its fit: evidence, chi-squared, numbers, history.
void describe_fit(const FitContext& context, const PosteriorFit& fit, const std::vector<AddedParameter>& added, Alternative& a) {
  const DiagnosisInputs& in = context.in;
  const PosteriorFit& base = context.base.fit;
  const LocalMode& mode = fit.modes[0];
  const LogPosterior& posterior = *fit.posterior;
  Explanation& e = a.explanation;
  e.fitted = true;
  e.log_bayes_factor = log_bayes_factor(fit, base) + a.selection_penalty;
  e.by_scale = evidence_by_scale(posterior, mode, fit.hypotheses, e.log_bayes_factor);
  const Cholesky plain = plain_errors(fit, posterior, mode, *fit.errors);
  e.chi2 = plain_chi2(plain, *fit.errors, fit, mode);
  e.base_chi2 = plain_chi2(plain, *fit.errors, base, context.base.mode());
  e.base_prior_deviation = root_mean_square(prior_deviations(in, mode.at.theta));
  const Moments moments = reported_moments(fit, in.base.seed);
  a.base_parameters = own_parameters(in, posterior, moments);
  const std::size_t n = in.base.parameters.size();
  for (std::size_t i = 0; i < added.size(); ++i) {
    const auto k = Eigen::Index(n + i);
    a.numbers.push_back(reported_number(in, added[i], moments.mean[k], moments.sd[k], a.base_parameters));
    if (!a.sensor.empty()) a.numbers.back().name.insert(0, a.sensor + '.');
    e.farthest = std::max(e.farthest, implausibility(added[i], mode.at.theta[n + i]));
  }
  a.history = kept(fit.history_at_mode());
  e.misfit = misfit_of_history(base, values_of(a.history));
}

/// Turns an explanation whose fit failed half way into one that explains no more than the base model.
void forget_fit(const BaseEvidence& base, Alternative& a) {
  Explanation& e = a.explanation;
  e.fitted = false;
  e.log_bayes_factor = 0;
  e.base_chi2.reset();
  e.farthest = 0;
  e.by_scale = base.by_scale;
  e.chi2 = base.chi2;
  e.misfit = base.misfit;
  e.base_prior_deviation = base.base_prior_deviation;
  a.numbers.clear();
  a.base_parameters.clear();
  a.history.clear();
}

}  // namespace

std::optional<Alternative> fit_explanation(const FitContext& context, const ParameterGroup& group, const ScreenedCandidate& screened,
                                           const Alternative* on_top_of, double best) {
  const DiagnosisInputs& in = context.in;
  RunBudget& budget = context.budget;
  Alternative a = unfitted_alternative(group, screened, on_top_of);
  if (!on_top_of) {
    a.sensor = group.sensor;
    a.explanation.of_a_gauge = !a.sensor.empty();
  }
  Below below = below_of(context, on_top_of);
  CandidatePlan plan = plan_candidate(below.inputs, below.fit, group, screened);
  std::vector<AddedParameter> added = std::move(below.added);
  added.insert(added.end(), plan.added.begin(), plan.added.end());
  if (const int first = first_runs(plan); !budget.allows(first)) {
    budget.skip({.kind = SkippedStep::Kind::fit, .name = a.explanation.name, .runs = first, .made = budget.made(), .limit = budget.limit()});
    budget.note_exhausted();
    return {};
  }
  in.say(FitBegins{a.explanation.name, budget.made()});
  bool ended = false;  // by the limit
  plan.inputs.run = [&](const Eigen::MatrixXd& thetas, const std::vector<int>& level) {
    const bool beyond = in.base.box.shrinks() && !budget.allows(int(level.size()));  // a search of the model itself may take any number
    ended = ended || beyond;
    if (beyond) throw RunLimitReached();
    return budget.run(thetas, level, added);
  };
  if (context.base.place_changes.size()) plan.inputs.gauge_places = [&](std::span<const double>) { return context.base.place_changes; };
  const std::vector<Parameter> parameters = plan.inputs.parameters;
  const auto round_done = [&](const PosteriorRound& r) {
    if (in.round) in.round(r, parameters);
  };
  const int before = budget.made();
  try {
    const auto wanted = [&](std::optional<double> of_fit) { return (!of_fit || may_lead(*of_fit + a.selection_penalty, best)) && !budget.used_up(); };
    CandidateFit made = fit_candidate(std::move(plan), context.base.fit, wanted, round_done);
    const PosteriorFit& fit = made.fit;
    describe_fit(context, fit, added, a);
    a.settled = made.stable;
    if (ended) budget.skip({.kind = SkippedStep::Kind::search_cut_short, .name = a.explanation.name, .limit = budget.limit()});
    if (!a.settled && (ended || budget.used_up())) budget.note_exhausted();
    if (made.stable && !fit.settled)
      a.status = {.kind = FitStatus::Kind::stable, .coarse = fit.rounds.back().coarse, .fine = fit.rounds.back().fine};
    else
      a.status = {.kind = FitStatus::Kind::emulator, .settling = fit.settling()};
    made.inputs.run = {};  // what they refer to ends here
    context.library.fits.emplace(a.explanation.name, ExplanationFit{added, std::move(made.inputs), std::move(made.fit)});
  } catch (const NumericsError& e) {
    const bool at_the_limit = dynamic_cast<const RunLimitReached*>(&e) != nullptr;
    const std::string message = at_the_limit ? "" : e.what();
    if (ended) {
      budget.skip({.kind = SkippedStep::Kind::fit_ended, .name = a.explanation.name, .message = message, .limit = budget.limit()});
      budget.note_exhausted();
    }
    if (ended && !on_top_of)
      a = first_order_explanation(in, context.base, group, screened);
    else
      forget_fit(context.base.evidence, a);
    if (at_the_limit)
      a.status = {.kind = FitStatus::Kind::run_limit, .run_limit = budget.limit()};
    else
      a.status = {.kind = FitStatus::Kind::failed, .message = message};
  }
  a.runs = budget.made() - before;
  report_fitted(context, a);
  return a;
}

Alternative first_order_explanation(const DiagnosisInputs& in, const BaseFit& base, const ParameterGroup& group, const ScreenedCandidate& screened) {
  Alternative a = unfitted_alternative(group, screened, nullptr);
  a.sensor = group.sensor;
  const FirstOrderEstimate& estimate = screened.first_order;
  Explanation& e = a.explanation;
  e.of_a_gauge = !a.sensor.empty();
  e.log_bayes_factor = estimate.log_bayes_factor;
  e.chi2 = base.evidence.chi2;
  e.misfit = base.evidence.misfit;
  e.base_prior_deviation = base.evidence.base_prior_deviation;
  for (std::size_t i = 0; i < screened.numbers.size(); ++i) {
    const auto k = Eigen::Index(i);
    const AddedParameter& number = group.added[screened.numbers[i]];
    const double sd = tempered_sd(estimate.sd[k], screened.directions.prior_sd[k]);
    a.numbers.push_back(reported_number(in, number, *number.parameter.nominal + estimate.value[k], sd, base.parameters));
  }
  e.by_scale = base.evidence.by_scale;  // it leaves what the base model leaves
  for (auto& s : e.by_scale) s.log_evidence = estimate.log_bayes_factor + std::min(0.0, s.log_evidence);
  a.status.kind = FitStatus::Kind::first_order;
  return a;
}

}  // namespace calomel
