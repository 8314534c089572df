#include "uq/diagnosis/diagnosis.hpp"

#include "uq/diagnosis/fit_measures.hpp"
#include "uq/diagnosis/judgement.hpp"
#include "uq/diagnosis/leading_fits.hpp"
#include "uq/diagnosis/pair_fits.hpp"

namespace calomel {

namespace {

/// Screens all groups about the base fit, and notes those for which there is no candidate.
std::vector<ScreenedCandidate> screen_about_base(const DiagnosisInputs& in, const BaseFit& base, RunBudget& budget) {
  in.say(ScreeningBegins{});
  ScreeningResult result = screen_candidates(screening_about(in, budget, base.fit, {}, in.groups));
  for (const auto& group : result.not_screened) {
    if (group.failure)
      budget.skip({.kind = SkippedStep::Kind::screening_failed, .name = group.label, .message = *group.failure});
    else
      budget.skip({.kind = SkippedStep::Kind::no_effect, .name = group.label});
  }
  for (const auto& candidate : result.candidates) {
    const double evidence = candidate.first_order.log_bayes_factor;
    if (!(evidence > least_to_fit)) continue;
    in.say(CandidateScreened{.label = label(candidate, in.groups, in.base.problem.shape), .log_bayes_factor = evidence, .p_value = candidate.p_value});
  }
  return std::move(result.candidates);
}

/// An offset of the clock of all records whose evidence leads that of every candidate. No mechanism is like it: a longer pulse (the beam's profile) comes
/// nearest.
std::optional<ClockOffset> leading_clock_offset(const DiagnosisInputs& in, const BaseFit& base, const std::vector<ScreenedCandidate>& screened) {
  const auto offset = clock_offset(in.base.problem, base.fit);
  if (!offset) return {};
  if (!screened.empty() && offset->log_bayes_factor < screened[0].first_order.log_bayes_factor + Gates{}.lead) return {};
  in.say(*offset);
  return offset;
}

/// The steps about mechanisms, from the screening to the verdict.
void explain(const FitContext& context, Diagnosis& d) {
  const auto screened = screen_about_base(context.in, d.base, context.budget);
  d.clock = leading_clock_offset(context.in, d.base, screened);
  fit_without_runs(context, screened);
  fit_leaders(context, screened);
  follow_many_small_numbers(context, screened);
  d.verdict = judge_candidates(context);
  if (context.in.options.pairs && fit_pairs(context, d.verdict)) d.verdict = judge_candidates(context);
}

/// The terms that would explain the records, where no explanation does.
std::optional<MissingTerms> describe_missing(const DiagnosisInputs& in, const Diagnosis& d, RunBudget& budget) {
  if (d.verdict.kind != VerdictKind::unknown || !d.base.mislabelled.empty() || in.terms.empty() || in.options.term_runs == 0) return {};
  if (const int runs = missing_terms_runs(in.terms); runs > in.options.term_runs) {
    budget.skip({.kind = SkippedStep::Kind::missing_terms, .runs = runs, .limit = in.options.term_runs});
    return {};
  }
  in.say(TermScreeningBegins{});
  return missing_terms(screening_about(in, budget, d.base.fit, {}, in.terms));
}

double mean_over(const std::vector<double>& x) {
  double sum = 0;
  for (const double v : x) sum += v;
  return sum / double(x.size());
}

VerdictMisfits misfits_of(const Diagnosis& d, const Problem& problem) {
  const Alternative* named = d.named();
  return {.before = mean_over(misfits_by_gauge(d.base.fit, d.base.history)),
          .after = mean_over(misfits_by_gauge(d.base.fit, named ? named->history : d.base.history)),
          .held_out_before = d.hold_out.before,
          .held_out_after = d.hold_out.after,
          .single_record = problem.observations.size() == 1};
}

}  // namespace

Diagnosis diagnose(const DiagnosisInputs& in) {
  RunBudget budget(in.run, in.options.max_runs);
  Diagnosis d;
  d.base = fit_base(in, budget);
  d.dead = in.base.problem.dead;
  const HeldOut held_out(in.base.problem, d.base.fit, in.base.places);
  d.base.evidence.held_out = held_out.mean(held_out.base().misfit);
  FitLibrary library;
  const FitContext context{.in = in, .base = d.base, .held_out = held_out, .budget = budget, .library = library};
  if (d.base.mislabelled.empty())
    explain(context, d);
  else
    d.verdict.ranking = judge(d.base.evidence, {}).ranking;
  d.hold_out = summarise_hold_out(context, d.verdict);
  d.candidates = std::move(library.candidates);
  d.location = locate_mismatch(in.base.problem, d.base.fit);
  d.missing = describe_missing(in, d, budget);
  d.separating = separating_measurement(in.base.problem, d.base, d.candidates, d.verdict);
  d.misfits = misfits_of(d, in.base.problem);
  d.runs = budget.made();
  d.budget_exhausted = budget.exhausted();
  d.skipped = budget.skipped();
  return d;
}

std::vector<std::string> Diagnosis::unsettled() const {
  if (verdict.mechanisms.empty()) {
    if (!base.fit.settled) return {"base"};
    const auto all = by_evidence();
    if (!budget_exhausted || verdict.kind != VerdictKind::unknown || all.empty()) return {};
    const Gate failed = gate_not_passed(base.evidence, all, 0);  // the explanation has no fit, or leaves what a second effect may take: pairs come last
    const bool more_runs = failed == Gate::fitted || ((failed == Gate::explained || failed == Gate::remainder) && !all[0].of_two);
    return more_runs ? std::vector{all[0].name} : std::vector<std::string>{};
  }
  std::vector<std::string> names;
  for (const auto& name : verdict.mechanisms)
    if (const Alternative* a = alternative(name); a && !a->settled) names.push_back(name);
  return names;
}

}  // namespace calomel
