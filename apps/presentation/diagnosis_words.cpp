#include "apps/presentation/diagnosis_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <variant>

#include "apps/presentation/data_check_words.hpp"

namespace calomel {

namespace {

constexpr double hardly = 3;  ///< log Bayes factor up to which the records do not support an explanation

std::string capital(std::string text) {
  if (!text.empty()) text[0] = char(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string sentence(const std::string& text) { return capital(text) + (text.ends_with('.') ? "" : "."); }

/// "the proton beam's profile (beam_profile)"
std::string with_key(const Alternative& a, std::span<const ParameterGroup> groups) {
  const std::string plain = plain_name(a, groups), &name = a.explanation.name;
  return plain == name ? name : plain + " (" + name + ')';
}

/// Where the mismatch is first significant, else where it is greatest.
std::string where(const LocatedMismatch& l) {
  if (!l.first_sensor.empty())
    return l.first_time > 0 ? fmt::format("at gauge {} from {} on, where the mismatch is first seen", l.first_sensor, time_text(l.first_time))
                            : fmt::format("at gauge {}, which shows the mismatch from the start", l.first_sensor);
  const auto most = std::max_element(l.sensors.begin(), l.sensors.end(), [](const auto& a, const auto& b) { return a.score < b.score; });
  return most == l.sensors.end() ? "at the gauges with the greatest mismatch" : "at gauge " + most->name + ", where the mismatch is greatest";
}

std::string held_out_records(const VerdictMisfits& m) { return m.single_record ? "stretches of the record" : "gauges"; }

/// ", and on gauges that were left out of the fit from 12 % to 6.0 %"; says so where it does not fall. Empty where no gauge was held out.
std::string held_out_part(const Alternative& a, const VerdictMisfits& m) {
  if (a.held_out.empty() || !(m.held_out_before > 0)) return "";
  const std::string from_to = fmt::format("{} to {}", percent(m.held_out_before), percent(m.held_out_after));
  return m.held_out_after < m.held_out_before ? ", and on " + held_out_records(m) + " that were left out of the fit from " + from_to
                                              : ", but on " + held_out_records(m) + " that were left out of the fit it does not fall (" + from_to + ")";
}

std::string what_to_check(const Alternative& a, std::span<const ParameterGroup> groups) {
  std::vector<std::string> all;
  for (const auto& name : a.groups)
    if (const auto* g = group_of(groups, name); g && !g->check.empty()) all.push_back(g->check);
  return listed(all);
}

std::string tables_of(const Alternative& a) {
  std::vector<std::string> all;
  for (const auto& name : a.groups) all.push_back("[mechanism." + name + "]");
  return listed(all);
}

/// The change of the misfit with an explanation. The misfit of the fitted records may rise: without the explanation the base parameters had bent to them.
std::string misfit_part(const Alternative& a, const VerdictMisfits& m) {
  if (m.after < m.before || a.held_out.empty() || m.held_out_after >= m.held_out_before)
    return fmt::format("the misfit of the records {} from {} to {}{}", m.after < m.before ? "falls" : "goes", percent(m.before), percent(m.after),
                       held_out_part(a, m));
  return fmt::format(
      "the misfit of {} that were left out of the fit falls from {} to {} (that of the records that were fitted goes from {} to {}: without it the base "
      "parameters had bent to them)",
      held_out_records(m), percent(m.held_out_before), percent(m.held_out_after), percent(m.before), percent(m.after));
}

/// Both sentences of a verdict that names one explanation.
PlainSummary named_summary(const Alternative& a, std::span<const ParameterGroup> groups, const VerdictMisfits& m) {
  const std::string falls = misfit_part(a, m);
  std::vector<std::string> gauges{a.sensor};
  gauges.insert(gauges.end(), a.other_sensors.begin(), a.other_sensors.end());
  if (!a.sensor.empty())
    return {fmt::format("Gauge {} does not read true ({}: {}), and the simulation explains the records once that is allowed for: {}.{}", a.sensor,
                        a.explanation.name, plain_size(a, groups), falls,
                        a.other_sensors.empty() ? "" : fmt::format(" The records do not tell whether it is this gauge or {}.", listed(a.other_sensors, "or"))),
            fmt::format("Check gauge {}, its calibration, amplifier, clock and orientation, or leave it out (recordings.exclude), and run the diagnosis again.",
                        listed(gauges))};
  const std::string check = what_to_check(a, groups);
  return {fmt::format("The simulation leaves something out: {}; with it {}.", with_key(a, groups), falls),
          sentence((check.empty() ? "make it" : check + "; if that agrees, make it") + " part of the model (" + tables_of(a) +
                   ", enabled = true, with the numbers found) and calibrate again")};
}

PlainSummary unknown_summary(const Diagnosis& d, std::span<const ParameterGroup> groups, const Gates& gates) {
  const VerdictMisfits& m = d.misfits;
  const std::string misfit = fmt::format("(misfit {})", percent(m.before));
  const bool one_place = d.base.evidence.local && *d.base.evidence.local > gates.lead;
  const std::string alone = !one_place ? ""
                            : d.base.likeliest_place.size() > 1
                                ? fmt::format(" (it shows near gauges {} alone)", listed(d.base.likeliest_place))
                                : fmt::format(" (it shows near gauge {} alone: see whether it reads true)", d.base.likeliest_place[0]);
  const std::string look = fmt::format(
      "Look first {}{}: something that is not in the catalogue may be missing, such as a part of the geometry, or several effects at once, so do not take "
      "calibrated values for properties of the "
      "material until it is found.",
      where(d.location), alone);
  const PlainSummary nothing{fmt::format("The simulation leaves something out {}, and none of the effects that were tried is it.", misfit), look};
  const auto all = d.by_evidence();
  if (all.empty()) return nothing;
  const Alternative& best = *d.alternative(all[0].name);
  const std::string name = plain_name(best, groups), differ = fmt::format("The simulation and the records differ {}", misfit);
  const std::string begin = fmt::format("The simulation leaves something out {}, and it is not known what: ", misfit) + name;
  const std::string finer = "Repeat the diagnosis on finer meshes (emulator.element_sizes) before any physics is blamed.";
  switch (gate_not_passed(d.base.evidence, all, 0, gates)) {
    case Gate::fitted:
      if (all[0].log_bayes_factor < gates.log_bayes_factor) return nothing;
      return {begin + " comes nearest to first order, but was not fitted.",
              "Run the diagnosis again with --fresh and more diagnosis.leaders or diagnosis.max_runs; the runs that were made are kept."};
    case Gate::evidence:
      if (all[0].log_bayes_factor <= hardly) return nothing;
      return {fmt::format("The simulation leaves something out {}, and nothing that was tried is sure enough to be named: {} comes nearest.", misfit, name),
              look};
    case Gate::numerical:
      return {differ + ", but the simulation's own discretisation accounts for it better than any physics that was tried.", finer};
    case Gate::numerical_rival:
      return {differ + "; " + name + " would account for it, but the simulation's own discretisation does so nearly as well.", finer};
    case Gate::explained:
      return {begin + fmt::format(" comes nearest, but accounts for only {:.0f} % of the mismatch.",
                                  100 * share_explained(d.base.evidence, all[0], gates).value_or(0)),
              look};
    case Gate::remainder:
      return {begin + " comes nearest, but with it the records are still not explained.", look};
    case Gate::probability:
      return {begin + fmt::format(" comes nearest, with a probability of {:.0f} %, which is not enough for a name.",
                                  100 * class_probability(d.base.evidence, all, 0, gates)),
              look};
    case Gate::misfit:
      return {begin + " has the evidence, but with it the records are not nearer.", look};
    case Gate::held_out:
      return {begin + " has the evidence, but what was left out of the fit gains too little by it: it may imitate something else.", look};
    case Gate::plausible:
      return {begin + fmt::format(" would explain the records, but only if it were stronger than is plausible ({}).", plain_size(best, groups)),
              "Find out whether it can be that strong; if not, look " + where(d.location) + '.'};
    case Gate::handbook:
      return {begin + " would explain the records, but only with properties of the material farther from the handbook than without it.", look};
    default:
      return nothing;
  }
}

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

std::string separating_text(const std::optional<SeparatingMeasurement>& m) {
  if (!m) return "nothing was fitted that a further measurement could tell apart";
  return fmt::format(
      "{} and {} differ most at gauge {} about {}, by {:.2g} {} ({:.2g} standard deviations of its mean record and what is not known of it): more pulses, or a "
      "second gauge beside it, tell most there",
      m->first, m->second.empty() ? "the base model" : m->second, m->gauge, time_text(m->time), m->difference, m->unit, m->standard_deviations);
}

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
      return {a->first_order_log_bayes_factor > hardly
                  ? fmt::format("Looked at to first order only (log Bayes factor {:.3g} there): others promised more and were fitted.",
                                a->first_order_log_bayes_factor)
                  : std::string("Nothing in these records speaks for it."),
              a->first_order_log_bayes_factor > hardly ? "A fit of its own: raise diagnosis.leaders."
                                                       : "Records in which its effect shows: other gauges, more pulses."};
    case Gate::evidence:
      if (b <= hardly)
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

std::string missing_sentence(const MissingTerms& m) {
  if (m.terms.empty())
    return fmt::format("None of {} simple terms, each in a part of the mercury or on a stretch of a wall, would do what is missing.", m.screened);
  std::vector<std::string> all;
  for (const auto& t : m.terms) all.push_back(fmt::format("of {} by {} {}", t.what, plain_term(t), t.place));
  const std::string change = fmt::format("What is missing acts like a change {}.", listed(all)), with = all.size() == 1 ? "it" : "them";
  if (!(m.misfit_before > 0)) return change + " It holds where the effect is small alone: no run with " + with + " came through. This is a hint, not a name.";
  const std::string compared = fmt::format("a misfit of {}, where the base model leaves {}", percent(m.misfit_after), percent(m.misfit_before));
  if (m.misfit_after < m.misfit_before)
    return change + " With " + with + " a run leaves " + compared + ". This describes an effect and its place; it is not a name.";
  return change + " It holds where the effect is small alone: a run with " + with + " does not come nearer to the records (" + compared +
         "). This is a hint of the place at most, not a name.";
}

namespace {

/// The sentences of a verdict by its kind, as if every fit had settled and the data were in order.
PlainSummary summary_by_kind(const Diagnosis& d, std::span<const ParameterGroup> groups, const Gates& gates) {
  const VerdictMisfits& m = d.misfits;
  switch (d.verdict.kind) {
    case VerdictKind::none:
      return {fmt::format("The simulation explains these records within what is known of their errors (misfit {}): nothing that they could show was left out.",
                          percent(m.before)),
              "Calibrate with it as it is; more pulses, or gauges whose places are better known, would show smaller effects."};
    case VerdictKind::named:
      return named_summary(*d.named(), groups, m);
    case VerdictKind::ambiguous: {
      std::vector<std::string> all;
      for (const auto& name : d.verdict.mechanisms) all.push_back(with_key(*d.alternative(name), groups));
      return {fmt::format("The simulation leaves something out, but these records do not tell whether it is {}: with any one of them the misfit falls, from {} "
                          "to {} with the first.",
                          listed(all, "or"), percent(m.before), percent(m.after)),
              "To tell them apart: " + separating_text(d.separating) + '.'};
    }
    case VerdictKind::unknown:
      break;
  }
  return unknown_summary(d, groups, gates);
}

/// Changes the sentences where a fit that decides the verdict has not settled.
void add_unsettled(const Diagnosis& d, std::span<const ParameterGroup> groups, PlainSummary& summary) {
  const auto unsettled = d.unsettled();
  if (unsettled.empty()) return;
  std::vector<std::string> fits;
  for (const auto& name : unsettled) fits.push_back(name == "base" ? "the base model" : with_key(*d.alternative(name), groups));
  if (d.verdict.mechanisms.empty() && unsettled[0] != "base") {
    const bool fitted = d.alternative(unsettled[0])->explanation.fitted;
    summary = {fitted ? fmt::format("The simulation and the records differ. What comes nearest, {}, leaves a part of it, and no runs were left to look for a "
                                    "second effect beside it.",
                                    fits[0])
                      : fmt::format("The simulation and the records differ, and what comes nearest to first order, {}, was not fitted: no runs were left for "
                                    "it.",
                                    fits[0]),
               "Run the diagnosis again with --fresh and more runs (diagnosis.max_runs); those that were made are kept."};
    return;
  }
  summary.next_step = fmt::format(
      "Do not act on this yet: the fit of {} has not settled, so run the diagnosis again with --fresh and more {}; the runs that were made are kept.",
      listed(fits), d.budget_exhausted ? "runs (diagnosis.max_runs)" : "rounds, or runs a round (emulator.rounds, emulator.round_fine)");
}

/// Changes the sentences where the data are not in order; nothing else is worth doing before.
void add_data_checks(const Diagnosis& d, PlainSummary& summary) {
  if (!d.base.mislabelled.empty())
    summary.finding =
        fmt::format("The simulation and the records differ (misfit {}), but gauges look mixed up: what was left out was not asked.", percent(d.misfits.before));
  std::string checks;
  for (const auto& channel : d.base.mislabelled) checks += mislabelled_sentence(channel) + ' ';
  if (d.clock) checks += clock_sentence(*d.clock) + ' ';
  if (!checks.empty()) summary.next_step = checks + "Then run the diagnosis again: until that is cleared up, no verdict on physics holds.";
  if (!d.dead.empty()) summary.next_step += ' ' + plain_dead(d.dead);
}

}  // namespace

PlainSummary plain_summary(const Diagnosis& d, std::span<const ParameterGroup> groups, const Gates& gates) {
  PlainSummary summary = summary_by_kind(d, groups, gates);
  add_unsettled(d, groups, summary);
  add_data_checks(d, summary);
  return summary;
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

std::string fit_status_text(const Alternative& a) {
  switch (a.status.kind) {
    case FitStatus::Kind::unremarkable:
      return {};
    case FitStatus::Kind::first_order:
      return "to first order";
    case FitStatus::Kind::linearised_run_failed:
      return "a run about its numbers failed";
    case FitStatus::Kind::on_unsettled_fit:
      return "it stands on a fit that has not settled";
    case FitStatus::Kind::numbers_moved:
      return fmt::format("its numbers still moved after {} runs", a.runs);
    case FitStatus::Kind::stable:
      return fmt::format("evidence and numbers stood still from {} coarse and {} fine runs on", a.status.coarse, a.status.fine);
    case FitStatus::Kind::emulator:
    case FitStatus::Kind::failed:
      break;
  }
  return a.status.message;
}

namespace {

const char* no_effect_text = "none of its numbers changes the records by itself";

std::string skipped_text(const SkippedStep& s) {
  switch (s.kind) {
    case SkippedStep::Kind::mechanisms:
      return "what each mechanism would be worth, and everything after it: gauges look mixed up";
    case SkippedStep::Kind::no_effect:
      return s.name + ": " + no_effect_text;
    case SkippedStep::Kind::relinearisation:
      return fmt::format("{}: its numbers are asked for once more with {} runs, and {} are spent of diagnosis.max_runs = {}", s.name, s.runs, s.made, s.limit);
    case SkippedStep::Kind::fit:
      return fmt::format("{}: it begins with {} runs, and {} are spent of diagnosis.max_runs = {}", s.name, s.runs, s.made, s.limit);
    case SkippedStep::Kind::search_cut_short:
      return fmt::format("{}: diagnosis.max_runs = {} ended a search for its fit before it was done; the best that was found is told", s.name, s.limit);
    case SkippedStep::Kind::missing_terms:
      return fmt::format("what is missing: its terms take {} runs, and diagnosis.term_runs is {}", s.runs, s.limit);
    case SkippedStep::Kind::screening_failed:
    case SkippedStep::Kind::fit_ended:
      break;
  }
  return s.name + ": " + s.message;
}

/// Terms that were not screened, counted by the reason, and a run with the terms that failed.
std::vector<std::string> skipped_terms(const MissingTerms& m) {
  std::map<std::string, std::size_t> reasons;
  for (const auto& term : m.not_screened) ++reasons[term.failure.value_or(no_effect_text)];
  std::vector<std::string> all;
  for (const auto& [reason, count] : reasons) all.push_back(fmt::format("what is missing: {} of {} terms: {}", count, m.offered, reason));
  if (m.run_failure) all.push_back("what is missing: a run with the terms that were found: " + *m.run_failure);
  return all;
}

}  // namespace

std::vector<std::string> not_screened_texts(const std::vector<NotScreened>& groups) {
  std::vector<std::string> all;
  for (const auto& g : groups) all.push_back(g.label + ": " + g.failure.value_or(no_effect_text));
  return all;
}

std::vector<std::string> skipped_texts(const Diagnosis& d) {
  std::vector<std::string> all;
  for (const auto& step : d.skipped) all.push_back(skipped_text(step));
  if (!d.missing) return all;
  const auto terms = skipped_terms(*d.missing);
  all.insert(all.end(), terms.begin(), terms.end());
  return all;
}

namespace {

struct EventText {
  std::string operator()(const BaseFitBegins&) const { return "base fit"; }
  std::string operator()(const LocalEvidenceFound& e) const { return fmt::format("something in one place alone: log evidence {:.3g}", e.log_evidence); }
  std::string operator()(const MislabelledChannel& m) const { return mislabelled_sentence(m); }
  std::string operator()(const ClockOffset& c) const { return clock_sentence(c); }
  std::string operator()(const ScreeningBegins& s) const {
    if (s.on_top_of.empty()) return "what each mechanism would be worth, to first order";
    return fmt::format("what {} would be worth on top of {}, to first order", s.gauges_alone ? "a fault of each gauge" : "each mechanism", s.on_top_of);
  }
  std::string operator()(const CandidateScreened& c) const {
    if (c.on_top) return fmt::format("{}: log Bayes factor {:.3g} to first order on top of it", c.label, c.log_bayes_factor);
    return fmt::format("{}: log Bayes factor {:.3g} to first order, p {:.2g}", c.label, c.log_bayes_factor, c.p_value);
  }
  std::string operator()(const FitBegins& f) const { return fmt::format("fit of {} ({} runs so far)", f.name, f.runs); }
  std::string operator()(const ExplanationFitted& e) const {
    return fmt::format("{}: log Bayes factor {:.4g}, chi-squared {:.4g} for {:.0f} values ({:.4g} without it), {} runs", e.name, e.log_bayes_factor, e.chi2,
                       e.values, e.base_chi2, e.runs);
  }
  std::string operator()(const TermScreeningBegins&) const { return "which terms would do what is missing"; }
};

/// The words about one entry of the ranking.
ExplanationText explanation_text(const Diagnosis& d, const std::string& name, std::span<const ParameterGroup> groups) {
  const Why reasons = why(d, name, groups);
  ExplanationText text{.why = reasons.why, .would_change = reasons.would_change};
  const Alternative* a = d.alternative(name);
  if (!a) return text;
  text.plain_name = plain_name(*a, groups);
  text.size = plain_size(*a, groups);
  text.message = fit_status_text(*a);
  text.places = fitted_places(*a);
  for (const auto& n : a->numbers) {
    const PlainNumber plain = plain_number(*a, n, groups);
    text.numbers.push_back({.value = plain.value, .off = plain.off});
  }
  return text;
}

}  // namespace

std::string event_text(const DiagnosisEvent& event) { return std::visit(EventText{}, event); }

DiagnosisText diagnosis_text(const Diagnosis& d, std::span<const ParameterGroup> groups) {
  const PlainSummary summary = plain_summary(d, groups);
  DiagnosisText text{.reason = verdict_reason_text(d),
                     .finding = summary.finding,
                     .next_step = summary.next_step,
                     .separating_measurement = separating_text(d.separating),
                     .skipped = skipped_texts(d)};
  for (const auto& r : d.verdict.ranking) text.ranking.push_back(explanation_text(d, r.name, groups));
  for (const auto& channel : d.base.mislabelled) text.mislabelled.push_back(mislabelled_sentence(channel));
  if (d.clock) text.clock = clock_sentence(*d.clock);
  if (!d.missing) return text;
  text.missing = missing_sentence(*d.missing);
  for (const auto& term : d.missing->terms) text.missing_terms.push_back(plain_term(term));
  return text;
}

}  // namespace calomel
