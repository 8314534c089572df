#include "apps/presentation/diagnosis_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/presentation/data_check_words.hpp"
#include "apps/presentation/diagnosis_course.hpp"
#include "apps/presentation/diagnosis_reasons.hpp"

namespace calomel {

namespace {

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
      if (all[0].log_bayes_factor <= least_support) return nothing;
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

}  // namespace

std::string separating_text(const std::optional<SeparatingMeasurement>& m) {
  if (!m) return "nothing was fitted that a further measurement could tell apart";
  return fmt::format(
      "{} and {} differ most at gauge {} about {}, by {:.2g} {} ({:.2g} standard deviations of its mean record and what is not known of it): more pulses, or a "
      "second gauge beside it, tell most there",
      m->first, m->second.empty() ? "the base model" : m->second, m->gauge, time_text(m->time), m->difference, m->unit, m->standard_deviations);
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
