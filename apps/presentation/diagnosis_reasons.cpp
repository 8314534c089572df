#include "apps/presentation/diagnosis_reasons.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/presentation/diagnosis_course.hpp"
#include "apps/presentation/diagnosis_numbers.hpp"

namespace calomel {

namespace {

std::string chi2_words(double chi2, const BaseEvidence& base, const Gates& gates) {
  return fmt::format("chi-squared {:.4g} for {:.0f} values, where up to {:.4g} is plausible", chi2, base.values, greatest_plausible(base, gates));
}

/// For "none" and "unknown".
Why why_of_base(const Diagnosis& d, const std::string& name, const Gates& gates) {
  const BaseEvidence& base = d.base.evidence;
  if (name == "unknown") {
    if (d.verdict.kind == VerdictKind::unknown)
      return {"The base model does not explain the records, and no explanation that was tried passes every test.",
              "An effect that passes all tests: offer more mechanisms, or add one."};
    return {"It represents any cause that was not tried.", "A base model that does not explain the records, while no explanation passes the tests."};
  }
  const std::string chi2 = chi2_words(base.chi2, base, gates);
  if (base.chi2 <= greatest_plausible(base, gates))
    return {"The base model differs from the records by no more than their known errors (" + chi2 + ").",
            "More pulses or better known gauges: smaller errors show smaller effects."};
  return {"The base model differs from the records by more than their known errors (" + chi2 + ").", "Errors larger than those of [errors]."};
}

/// For an explanation that the verdict names, or of the class that it names.
Why why_named(const Diagnosis& d, const std::vector<Explanation>& all, const Explanation& e, std::span<const ParameterGroup> groups, const Gates& g) {
  const double share = 100 * share_explained(d.base.evidence, e, g).value_or(0), b = e.log_bayes_factor;
  const auto plain = [&](const std::string& name) { return plain_name(*d.alternative(name), groups); };
  if (d.verdict.kind == VerdictKind::ambiguous) {
    std::vector<std::string> others;
    for (const auto& other : d.verdict.mechanisms)
      if (other != e.name) others.push_back(plain(other));
    return {fmt::format("It may be the cause: it accounts for {:.0f} % of the mismatch (log Bayes factor {:.3g}). These records do not distinguish it from {}.",
                        share, b, listed(others)),
            "A measurement that distinguishes them."};
  }
  const auto next = std::find_if(all.begin(), all.end(), [&](const auto& x) { return x.name != e.name && !same_class(e, x); });
  std::string lead = "Nothing else was tried.";
  if (next != all.end())
    lead = fmt::format("The evidence of the next explanation, {}, is {:.3g} lower.", plain(next->name),
                       evidence_of_name(d.base.evidence, e, g) - evidence_of_name(d.base.evidence, *next, g));
  return {fmt::format("Named: it accounts for {:.0f} % of the mismatch with a log Bayes factor of {:.3g}. {}", share, b, lead),
          fmt::format("Another explanation whose evidence comes within {:.0f} of it, or a record that it does not explain.", g.lead)};
}

/// For an explanation without a fit.
Why why_not_fitted(const Alternative& a) {
  if (const std::string status = fit_status_text(a); !status.empty() && a.status.kind != FitStatus::Kind::first_order)
    return {"Its fit failed: " + status + '.', "A fit that succeeds."};
  if (a.first_order_log_bayes_factor <= least_support)
    return {"Nothing in these records supports it.", "Records in which its effect shows: other gauges, or more pulses."};
  return {fmt::format("It was estimated to first order only (log Bayes factor {:.3g}), because other explanations had more evidence and were fitted.",
                      a.first_order_log_bayes_factor),
          "A fit of its own: raise diagnosis.leaders."};
}

/// For an explanation that fails Gate::evidence.
Why why_too_weak(double log_bayes_factor, const Gates& g) {
  if (log_bayes_factor <= least_support)
    return {fmt::format("Nothing in these records supports it (log Bayes factor {:.2g}).", log_bayes_factor),
            "Records in which its effect shows: other gauges, or more pulses."};
  return {fmt::format("The records support it too weakly: its log Bayes factor is {:.3g}, and a name needs {:.0f}.", log_bayes_factor, g.log_bayes_factor),
          fmt::format("An effect about {:.1f} times as large, or errors smaller by that factor.", std::sqrt(g.log_bayes_factor / log_bayes_factor))};
}

/// For an explanation that fails Gate::explained or Gate::remainder.
Why why_it_leaves_too_much(const Diagnosis& d, const Explanation& e, const Gates& g) {
  const double share = share_explained(d.base.evidence, e, g).value_or(0), left = 100 - 100 * share;
  const std::string chi2 = chi2_words(e.chi2, d.base.evidence, g), second = "A second effect that accounts for the rest.";
  if (e.of_two)
    return {fmt::format("With both mechanisms the records are still not explained ({}): they leave {:.0f} % of the mismatch. Two mechanisms may leave no more "
                        "than chance does.",
                        chi2, left),
            "Physics that was not offered, which the two imitate together."};
  if (share < g.explained)
    return {fmt::format("It accounts for only {:.0f} % of the mismatch. A name that leaves more than chance does has to account for {:.0f} %.", 100 * share,
                        100 * least_explained(g)),
            second};
  return {fmt::format("With it the records are still not explained ({}). It leaves {:.0f} % of the mismatch, and a name may leave {:.0f} %.", chi2, left,
                      100 * (1 - least_explained(g))),
          second};
}

/// For an explanation that fails Gate::held_out.
Why why_it_predicts_too_little(const BaseEvidence& base, const Explanation& e) {
  const std::string too_little = "The misfit of records that were left out of the fit falls too little with it: ";
  const auto& p = e.hold_out_prediction;
  if (!p)
    return {too_little + fmt::format("it is {}, and {} without it.", percent(e.held_out.value_or(0)), percent(base.held_out)),
            "More gauges, so that its predictions can be tested."};
  const std::string gauges = e.held_out ? fmt::format("that of gauges is {}, and {} without it; ", percent(*e.held_out), percent(p->gauges_before)) : "";
  return {too_little + gauges +
              fmt::format("that of the first quarter of the records is {}, and {} without it.", percent(p->beginning), percent(p->beginning_before)),
          "Records that begin before the pulse, and more gauges: all of them show the remains of earlier pulses."};
}

}  // namespace

Why why(const Diagnosis& d, const std::string& name, std::span<const ParameterGroup> groups, const Gates& g) {
  const Alternative* a = d.alternative(name);
  if (!a) return why_of_base(d, name, g);
  const BaseEvidence& base = d.base.evidence;
  const auto all = d.by_evidence();
  const auto at = std::size_t(std::find_if(all.begin(), all.end(), [&](const auto& e) { return e.name == name; }) - all.begin());
  const Explanation& e = all[at];
  const auto& names = d.verdict.mechanisms;
  if (std::find(names.begin(), names.end(), name) != names.end()) return why_named(d, all, e, groups, g);
  const std::string best = plain_name(*d.alternative(all[0].name), groups);
  switch (gate_not_passed(base, all, at, g)) {
    case Gate::fitted:
      return why_not_fitted(*a);
    case Gate::evidence:
      return why_too_weak(e.log_bayes_factor, g);
    case Gate::numerical:
      return {"It is no physics: a number of the simulation's discretisation explains the records.", "Finer meshes (emulator.element_sizes)."};
    case Gate::competitor:
      return {fmt::format("{} explains the records better (evidence {:.3g} against {:.3g}).", capital(best), evidence_of_name(base, all[0], g),
                          evidence_of_name(base, e, g)),
              fmt::format("Records that support it and not {}.", best)};
    case Gate::numerical_competitor:
      return {"A number of the simulation's discretisation explains the records nearly as well.", "Finer meshes (emulator.element_sizes)."};
    case Gate::explained:
    case Gate::remainder:
      return why_it_leaves_too_much(d, e, g);
    case Gate::misfit:
      return {fmt::format("With it the misfit of the records does not fall: it is {}, and {} without it.", percent(e.misfit), percent(base.misfit)),
              "A fit with it that comes nearer to the records."};
    case Gate::held_out:
      return why_it_predicts_too_little(base, e);
    case Gate::plausible:
      return {fmt::format("It would have to be stronger than is plausible ({}).", plain_size(*a, groups)), "Independent evidence that it can be that strong."};
    case Gate::handbook:
      return {"With it the base parameters lie farther from the handbook than without it.", "Handbook values that are known to differ from the priors."};
    case Gate::probability:
      return {fmt::format("Its probability is {:.0f} %, and a name needs more than {:.0f} %. Another effect, or a further one beside it, is possible as well.",
                          100 * class_probability(base, all, at, g), 100 * g.believed),
              "Records that support it and not the others, or a second effect that accounts for the rest."};
    case Gate::passed:
      return {sentence(verdict_reason_text(d, g)), "A record or a measurement that supports it alone."};
  }
  return {};
}

namespace {

/// The gate that the leading explanation fails, for a verdict that names nothing although the explanation has the evidence.
std::string failed_gate_text(const BaseEvidence& base, const Explanation& best, const VerdictReason& reason) {
  const std::string& name = best.name;
  const auto misfits = [](double after, double before) { return fmt::format("{:.3g} % and was {:.3g} %", 100 * after, 100 * before); };
  switch (reason.gate) {
    case Gate::fitted:
      return fmt::format(
          "{} comes nearest, with a log Bayes factor of {:.3g} to first order, but was not fitted in the true model: raise diagnosis.leaders or "
          "diagnosis.max_runs",
          name, best.log_bayes_factor);
    case Gate::numerical:
      return name + ", a number of the discretisation, explains the records better than any physics that was offered";
    case Gate::numerical_competitor:
      return fmt::format("{}, a number of the discretisation, explains the records about as well as {}", reason.numerical_competitor, name);
    case Gate::explained:
      return fmt::format("{} comes nearest, but explains only {:.0f} % of the base model's mismatch", name, 100 * reason.explained);
    case Gate::remainder:
      return fmt::format(
          "{} comes nearest, but with it the records are still not explained: it leaves {:.0f} % of the base model's mismatch (chi-squared {:.4g} for {:.0f} "
          "values)",
          name, 100 * (1 - reason.explained), best.chi2, base.values);
    case Gate::misfit:
      return fmt::format("{} has the evidence, but with it the misfit of the records does not fall: it is {}", name, misfits(best.misfit, base.misfit));
    case Gate::held_out: {
      const auto& p = best.hold_out_prediction;
      if (!p)
        return fmt::format(
            "{} has the evidence, but the misfit of gauges that were left out of the fit falls too little: it is {}, and that of the records is {}", name,
            misfits(*best.held_out, base.held_out), misfits(best.misfit, base.misfit));
      const std::string gauges = best.held_out ? fmt::format("that of gauges is {}, and ", misfits(*best.held_out, p->gauges_before)) : "";
      return fmt::format(
          "{} has the evidence, but the misfit of records that were left out of the fit falls too little: {}that of the first quarter of all records is {}",
          name, gauges, misfits(p->beginning, p->beginning_before));
    }
    case Gate::plausible:
      if (!std::isfinite(best.farthest)) return name + " would explain the records, but only with a number outside its range";
      return fmt::format("{} would explain the records, but only with a number {:.2g} standard deviations from the middle of its prior", name, best.farthest);
    case Gate::handbook:
      return name + " would explain the records, but only with base parameters farther from the handbook than without it";
    case Gate::probability:
      return fmt::format("{} comes nearest, but its probability is only {:.0f} %", name, 100 * reason.probability);
    case Gate::evidence:
    case Gate::competitor:
    case Gate::passed:
      break;
  }
  return {};
}

}  // namespace

std::string verdict_reason_text(const BaseEvidence& base, const std::vector<Explanation>& all, const Verdict& verdict, const Gates& gates) {
  const VerdictReason& reason = verdict.reason;
  const auto best = std::find_if(all.begin(), all.end(), [&](const auto& e) { return e.name == reason.leading; });
  if (!verdict.mechanisms.empty())
    return fmt::format("{} explains {:.0f} % of the base model's mismatch (log Bayes factor {:.3g}, lead {:.3g})", best->name, 100 * reason.explained,
                       best->log_bayes_factor, reason.lead);
  const bool too_weak = best == all.end() || best->log_bayes_factor < gates.log_bayes_factor;
  if (!too_weak) return failed_gate_text(base, *best, reason);
  if (reason.base_adequate)
    return fmt::format("the base model explains the records within their errors (chi-squared {:.4g} for {:.0f} values)", base.chi2, base.values);
  const std::string unexplained =
      fmt::format("the base model does not explain the records (chi-squared {:.4g} for {:.0f} values), and ", base.chi2, base.values);
  if (best == all.end()) return unexplained + "no mechanism was offered";
  return unexplained + fmt::format("no explanation has enough evidence: the best, {}, has a log Bayes factor of {:.3g}, below {:.3g}", best->name,
                                   best->log_bayes_factor, gates.log_bayes_factor);
}

std::string verdict_reason_text(const Diagnosis& d, const Gates& gates) {
  if (!d.base.mislabelled.empty()) return "channels appear to be mixed up, and no mechanism was screened";
  return verdict_reason_text(d.base.evidence, d.by_evidence(), d.verdict, gates);
}

}  // namespace calomel
