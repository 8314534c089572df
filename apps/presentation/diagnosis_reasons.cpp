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

Why why_of_base(const Diagnosis& d, const std::string& name, const Gates& gates) {
  const bool adequate = d.base.evidence.chi2 <= greatest_plausible(d.base.evidence, gates);
  const std::string chi2 = chi2_words(d.base.evidence.chi2, d.base.evidence, gates);
  if (name == "unknown")
    return {d.verdict.kind == VerdictKind::unknown ? "The records are not explained by the base model, and nothing that was tried passes every test."
                                                   : "Stands for anything that was not tried.",
            d.verdict.kind == VerdictKind::unknown ? "An effect that passes all tests: offer more mechanisms, or add one."
                                                   : "Nothing that was tried passing the tests, while the base model does not explain the records."};
  return adequate ? Why{"The base model differs from the records by no more than is known of their errors (" + chi2 + ").",
                        "More pulses or better known gauges: smaller errors show smaller effects."}
                  : Why{"The base model differs from the records by more than is known of their errors (" + chi2 + ").",
                        "Errors that are larger than [errors] says."};
}

/// For an explanation that fails Gate::explained or Gate::remainder.
Why why_it_leaves_too_much(const Diagnosis& d, const Explanation& e, const Gates& g) {
  const double share = share_explained(d.base.evidence, e, g).value_or(0), left = 100 - 100 * share;
  const std::string chi2 = chi2_words(e.chi2, d.base.evidence, g), second = "A second effect beside it that accounts for the rest.";
  if (e.of_two)
    return {
        fmt::format(
            "With both the records are still not explained ({}): they leave {:.0f} % of the mismatch, and two together have to leave no more than chance does.",
            chi2, left),
        "Physics that was not offered, which the two together imitate."};
  if (share < g.explained)
    return {fmt::format("It accounts for {:.0f} % of the mismatch only; {:.0f} % is asked where what it leaves is more than chance.", 100 * share,
                        100 * least_explained(g)),
            second};
  return {fmt::format("With it the records are still not explained ({}): it leaves {:.0f} % of the mismatch, where {:.0f} % is let pass.", chi2, left,
                      100 * (1 - least_explained(g))),
          second};
}

}  // namespace

Why why(const Diagnosis& d, const std::string& name, std::span<const ParameterGroup> groups, const Gates& g) {
  const Alternative* a = d.alternative(name);
  if (!a) return why_of_base(d, name, g);
  const auto all = d.by_evidence();
  const auto at = std::size_t(std::find_if(all.begin(), all.end(), [&](const auto& e) { return e.name == name; }) - all.begin());
  const Explanation& e = all[at];
  const double share = 100 * share_explained(d.base.evidence, e, g).value_or(0), b = e.log_bayes_factor;
  const Alternative& best = *d.alternative(all[0].name);
  const auto& names = d.verdict.mechanisms;
  if (std::find(names.begin(), names.end(), name) != names.end()) {
    if (d.verdict.kind == VerdictKind::named) {
      const auto next = std::find_if(all.begin(), all.end(), [&](const auto& x) { return x.name != name && !same_class(e, x); });
      const std::string behind = next == all.end()
                                     ? "nothing else was tried"
                                     : fmt::format("the evidence of the next, {}, lies {:.3g} below its own", plain_name(*d.alternative(next->name), groups),
                                                   evidence_of_name(d.base.evidence, e, g) - evidence_of_name(d.base.evidence, *next, g));
      return {fmt::format("Named: it accounts for {:.0f} % of the mismatch with a log Bayes factor of {:.3g}, and {}.", share, b, behind),
              fmt::format("Another explanation whose evidence comes within {:.0f} of it, or a record that it does not fit.", g.lead)};
    }
    std::vector<std::string> others;
    for (const auto& other : names)
      if (other != name) others.push_back(plain_name(*d.alternative(other), groups));
    return {fmt::format("May be it: it accounts for {:.0f} % of the mismatch (log Bayes factor {:.3g}), but {} cannot be told apart from it by these records.",
                        share, b, listed(others)),
            "A measurement that tells them apart."};
  }
  switch (gate_not_passed(d.base.evidence, all, at, g)) {
    case Gate::fitted:
      if (const std::string status = fit_status_text(*a); !status.empty() && a->status.kind != FitStatus::Kind::first_order)
        return {"Its fit failed: " + status + '.', "A fit that goes through."};
      return {a->first_order_log_bayes_factor > least_support
                  ? fmt::format("Looked at to first order only (log Bayes factor {:.3g} there): others promised more and were fitted.",
                                a->first_order_log_bayes_factor)
                  : std::string("Nothing in these records speaks for it."),
              a->first_order_log_bayes_factor > least_support ? "A fit of its own: raise diagnosis.leaders."
                                                              : "Records in which its effect shows: other gauges, more pulses."};
    case Gate::evidence:
      if (b <= least_support)
        return {fmt::format("Nothing in these records speaks for it (log Bayes factor {:.2g}).", b),
                "Records in which its effect shows: other gauges, more pulses."};
      return {fmt::format("The records speak for it, but too weakly: a log Bayes factor of {:.3g} where {:.0f} is asked.", b, g.log_bayes_factor),
              fmt::format("An effect about {:.1f} times as large, or errors as much smaller.", std::sqrt(g.log_bayes_factor / b))};
    case Gate::numerical:
      return {"It is no physics: a number of the simulation's discretisation explains the records.", "Finer meshes (emulator.element_sizes)."};
    case Gate::rival:
      return {fmt::format("{} explains the records better (evidence {:.3g} against {:.3g}).", capital(plain_name(best, groups)),
                          evidence_of_name(d.base.evidence, all[0], g), evidence_of_name(d.base.evidence, e, g)),
              fmt::format("Records that speak for it and against {}.", plain_name(best, groups))};
    case Gate::numerical_rival:
      return {"A number of the simulation's discretisation explains the records nearly as well.", "Finer meshes (emulator.element_sizes)."};
    case Gate::explained:
    case Gate::remainder:
      return why_it_leaves_too_much(d, e, g);
    case Gate::misfit:
      return {fmt::format("With it the records are not nearer: their misfit is {}, and {} without it.", percent(e.misfit), percent(d.base.evidence.misfit)),
              "A fit with it that comes nearer to the records."};
    case Gate::held_out:
      if (const auto& f = e.hold_out_prediction)
        return {fmt::format("What was left out of the fit gains too little by it: the misfit of {}the first quarter of the records is {}, and {} without it.",
                            e.held_out ? fmt::format("gauges is {}, and {} without it, that of ", percent(*e.held_out), percent(f->gauges_before)) : "",
                            percent(f->beginning), percent(f->beginning_before)),
                "Records that begin before the pulse, and more gauges: what earlier pulses left shows in all of them."};
      return {fmt::format("What was left out of the fit gains too little by it: its misfit is {}, and {} without it.", percent(e.held_out.value_or(0)),
                          percent(d.base.evidence.held_out)),
              "More gauges, so that a prediction can be held against records."};
    case Gate::plausible:
      return {fmt::format("It would have to be stronger than is plausible ({}).", plain_size(*a, groups)),
              "Knowing by other means that it can be that strong."};
    case Gate::handbook:
      return {"With it the base parameters lie farther from the handbook than without it.", "Handbook values that are known to be other than the priors say."};
    case Gate::probability:
      return {fmt::format("It has a probability of {:.0f} %, where more than {:.0f} % is asked: something else, or with it something more, may be it as well.",
                          100 * class_probability(d.base.evidence, all, at, g), 100 * g.believed),
              "Records that speak for it and against the others, or a second effect beside it that accounts for the rest."};
    case Gate::passed:
      return {sentence(verdict_reason_text(d, g)), "A record or a measurement that speaks for it alone."};
  }
  return {};
}

namespace {

/// What the leading explanation lacks, for a verdict that names nothing although the explanation has the evidence.
std::string failed_gate_text(const BaseEvidence& base, const Explanation& best, const VerdictReason& reason) {
  switch (reason.gate) {
    case Gate::fitted:
      return fmt::format(
          "{} comes nearest, with a log Bayes factor of {:.3g} to first order, but was not fitted in the true model: raise diagnosis.leaders or "
          "diagnosis.max_runs",
          best.name, best.log_bayes_factor);
    case Gate::numerical:
      return fmt::format("numerics: {} explains the records better than any physics that was offered", best.name);
    case Gate::numerical_rival:
      return fmt::format("numerics: {} explains as much as {}", reason.numerical_rival, best.name);
    case Gate::explained:
      return fmt::format("{} comes nearest, but explains only {:.0f} % of what the base model leaves", best.name, 100 * reason.explained);
    case Gate::remainder:
      return fmt::format(
          "{} comes nearest, but with it the records are still not explained: it leaves {:.0f} % of what the base model leaves (chi-squared {:.4g} "
          "for {:.0f} values)",
          best.name, 100 * (1 - reason.explained), best.chi2, base.values);
    case Gate::misfit:
      return fmt::format("{} has the evidence, but with it the records are not nearer: their misfit is {:.3g} % and was {:.3g} %", best.name, 100 * best.misfit,
                         100 * base.misfit);
    case Gate::held_out:
      if (const auto& p = best.hold_out_prediction)
        return fmt::format(
            "{} has the evidence, but what was left out of the fit gains too little by it: the misfit of {}the first quarter of all records is {:.3g} % and "
            "was {:.3g} %",
            best.name, best.held_out ? fmt::format("gauges is {:.3g} % and was {:.3g} %, that of ", 100 * *best.held_out, 100 * p->gauges_before) : "",
            100 * p->beginning, 100 * p->beginning_before);
      return fmt::format(
          "{} has the evidence, but gauges that were left out of the fit gain too little by it: their misfit is {:.3g} % and was {:.3g} %, where "
          "that of the records is {:.3g} % and was {:.3g} %",
          best.name, 100 * *best.held_out, 100 * base.held_out, 100 * best.misfit, 100 * base.misfit);
    case Gate::plausible:
      return fmt::format("{} would explain the records with a number {:.2g} standard deviations beyond what is plausible", best.name, best.farthest);
    case Gate::handbook:
      return fmt::format("{} would explain the records only with base parameters farther from the handbook than without it", best.name);
    case Gate::probability:
      return fmt::format("{} comes nearest, but has a probability of {:.0f} % only", best.name, 100 * reason.probability);
    case Gate::evidence:
    case Gate::rival:
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
    return fmt::format("{} explains {:.0f} % of what the base model leaves (log Bayes factor {:.3g}, lead {:.3g})", best->name, 100 * reason.explained,
                       best->log_bayes_factor, reason.lead);
  const bool too_weak = best == all.end() || best->log_bayes_factor < gates.log_bayes_factor;
  if (!too_weak) return failed_gate_text(base, *best, reason);
  if (reason.base_adequate)
    return fmt::format("the base model explains the records within their errors (chi-squared {:.4g} for {:.0f} values)", base.chi2, base.values);
  const std::string unexplained =
      fmt::format("the base model does not explain the records (chi-squared {:.4g} for {:.0f} values), and ", base.chi2, base.values);
  if (best == all.end()) return unexplained + "nothing was offered that could";
  return unexplained + fmt::format("nothing that was offered does: the best, {}, has a log Bayes factor of {:.3g}, below {:.3g}", best->name,
                                   best->log_bayes_factor, gates.log_bayes_factor);
}

std::string verdict_reason_text(const Diagnosis& d, const Gates& gates) {
  if (!d.base.mislabelled.empty()) return "gauges look mixed up, and nothing was asked of mechanisms";
  return verdict_reason_text(d.base.evidence, d.by_evidence(), d.verdict, gates);
}

}  // namespace calomel
