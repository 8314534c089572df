#include "apps/presentation/diagnosis_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/presentation/data_check_words.hpp"
#include "apps/presentation/diagnosis_course.hpp"
#include "apps/presentation/diagnosis_reasons.hpp"
#include "apps/presentation/fit_words.hpp"

namespace calomel {

namespace {

/// "the proton beam's profile (beam_profile)"
std::string with_key(const Alternative& a, std::span<const ParameterGroup> groups) {
  const std::string plain = plain_name(a, groups), &name = a.explanation.name;
  return plain == name ? name : plain + " (" + name + ')';
}

/// The place where the mismatch is first significant, else where it is greatest.
std::string where(const LocatedMismatch& l) {
  if (!l.first_sensor.empty())
    return l.first_time > 0 ? fmt::format("at gauge {} from {} on, where the mismatch is first significant", l.first_sensor, time_text(l.first_time))
                            : fmt::format("at gauge {}, which shows the mismatch from the start", l.first_sensor);
  const auto most = std::max_element(l.sensors.begin(), l.sensors.end(), [](const auto& a, const auto& b) { return a.score < b.score; });
  return most == l.sensors.end() ? "at the gauges with the greatest mismatch" : "at gauge " + most->name + ", where the mismatch is greatest";
}

/// "gauges that were left out of the fit"
std::string held_out_records(const VerdictMisfits& m) {
  return std::string(m.single_record ? "stretches of the record" : "gauges") + " that were left out of the fit";
}

/// ", and that of gauges that were left out of the fit from 12 % to 6.0 %", or that it does not fall. Empty where no gauge was held out.
std::string held_out_part(const Alternative& a, const VerdictMisfits& m) {
  if (a.held_out.empty() || !(m.held_out_before > 0)) return "";
  const std::string before = percent(m.held_out_before), after = percent(m.held_out_after);
  return m.held_out_after < m.held_out_before ? fmt::format(", and that of {} from {} to {}", held_out_records(m), before, after)
                                              : fmt::format(", but that of {} does not fall ({} to {})", held_out_records(m), before, after);
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

/// The change of the misfit with an explanation. The misfit of the fitted records may rise: without the explanation the base parameters had adapted to them.
std::string misfit_part(const Alternative& a, const VerdictMisfits& m) {
  const std::string before = percent(m.before), after = percent(m.after);
  if (m.after < m.before || a.held_out.empty() || m.held_out_after >= m.held_out_before)
    return fmt::format("the misfit of the records {} from {} to {}{}", m.after < m.before ? "falls" : "goes", before, after, held_out_part(a, m));
  return fmt::format(
      "the misfit of {} falls from {} to {}. That of the fitted records goes from {} to {}, because without it the base parameters had adapted to them",
      held_out_records(m), percent(m.held_out_before), percent(m.held_out_after), before, after);
}

/// The sentences of a verdict that names a fault of one gauge.
PlainSummary gauge_summary(const Alternative& a, std::span<const ParameterGroup> groups, const VerdictMisfits& m) {
  std::vector<std::string> gauges{a.sensor};
  gauges.insert(gauges.end(), a.other_sensors.begin(), a.other_sensors.end());
  std::string finding =
      fmt::format("Gauge {} does not read true ({}: {}). With that allowed for, {}.", a.sensor, a.explanation.name, plain_size(a, groups), misfit_part(a, m));
  if (!a.other_sensors.empty()) finding += fmt::format(" The records do not show whether the fault is at this gauge or at {}.", listed(a.other_sensors, "or"));
  return {
      std::move(finding),
      fmt::format("Check the calibration, amplifier, clock and orientation of gauge {}, or leave it out (recordings.exclude). Then run the diagnosis again.",
                  listed(gauges))};
}

/// The sentences of a verdict that names one explanation.
PlainSummary named_summary(const Alternative& a, std::span<const ParameterGroup> groups, const VerdictMisfits& m) {
  if (!a.sensor.empty()) return gauge_summary(a, groups, m);
  const std::string check = what_to_check(a, groups);
  const std::string make = "ake it part of the model (" + tables_of(a) + ", enabled = true, with the numbers found) and calibrate again.";
  return {fmt::format("The simulation leaves something out: {}. With it {}.", with_key(a, groups), misfit_part(a, m)),
          check.empty() ? "M" + make : sentence(check) + " If that agrees, m" + make};
}

/// A sentence about the place where the mismatch shows alone; empty where it shows in several.
std::string one_place(const Diagnosis& d, const Gates& gates) {
  const auto& place = d.base.likeliest_place;
  if (!d.base.evidence.local || !(*d.base.evidence.local > gates.lead)) return "";
  if (place.size() > 1) return fmt::format(" The mismatch shows near gauges {} alone.", listed(place));
  return fmt::format(" The mismatch shows near gauge {} alone, so check whether that gauge reads true.", place[0]);
}

PlainSummary unknown_summary(const Diagnosis& d, std::span<const ParameterGroup> groups, const Gates& gates) {
  const std::string misfit = percent(d.misfits.before);
  const std::string look = fmt::format(
      "Look first {}.{} An effect outside the catalogue may be missing, such as a part of the geometry, or several effects at once. Until it is found, do not "
      "use calibrated values as properties of the material.",
      where(d.location), one_place(d, gates));
  const PlainSummary nothing{fmt::format("The simulation leaves something out (misfit {}), and none of the effects that were tried explains it.", misfit),
                             look};
  const auto all = d.by_evidence();
  if (all.empty()) return nothing;
  const Alternative& best = *d.alternative(all[0].name);
  const std::string name = plain_name(best, groups);
  const std::string nearest =
      fmt::format("The simulation leaves something out (misfit {}), and the cause is unknown. The nearest explanation is {}", misfit, name);
  const std::string finer = "Repeat the diagnosis on finer meshes (emulator.element_sizes) before any physics is blamed.";
  switch (gate_not_passed(d.base.evidence, all, 0, gates)) {
    case Gate::fitted:
      if (all[0].log_bayes_factor < gates.log_bayes_factor) return nothing;
      return {nearest + ", which was estimated to first order and not fitted.",
              "Run the diagnosis again with --fresh and a greater diagnosis.leaders or diagnosis.max_runs. The runs that were made are kept."};
    case Gate::evidence:
      if (all[0].log_bayes_factor <= least_support) return nothing;
      return {fmt::format("The simulation leaves something out (misfit {}), and no effect has enough evidence to be named. The nearest explanation is {}.",
                          misfit, name),
              look};
    case Gate::numerical:
      return {fmt::format("The simulation and the records differ (misfit {}), but the simulation's own discretisation explains the difference better than any "
                          "physics that was tried.",
                          misfit),
              finer};
    case Gate::numerical_competitor:
      return {fmt::format("The simulation and the records differ (misfit {}). An effect, {}, would explain the difference, but the simulation's own "
                          "discretisation explains it nearly as well.",
                          misfit, name),
              finer};
    case Gate::explained:
      return {nearest + fmt::format(", but it accounts for only {:.0f} % of the mismatch.", 100 * share_explained(d.base.evidence, all[0], gates).value_or(0)),
              look};
    case Gate::remainder:
      return {nearest + ", but with it the records are still not explained.", look};
    case Gate::probability:
      return {nearest + fmt::format(", but its probability of {:.0f} % is not enough for a name.", 100 * class_probability(d.base.evidence, all, 0, gates)),
              look};
    case Gate::misfit:
      return {nearest + ". It has the evidence, but with it the misfit of the records does not fall.", look};
    case Gate::held_out:
      return {
          nearest + ". It has the evidence, but the misfit of records that were left out of the fit falls too little with it. It may imitate another effect.",
          look};
    case Gate::plausible:
      return {nearest + fmt::format(". It would explain the records, but only if it were stronger than is plausible ({}).", plain_size(best, groups)),
              "Find out whether it can be that strong. If not, look " + where(d.location) + '.'};
    case Gate::handbook:
      return {nearest + ". It would explain the records, but only with material properties farther from the handbook than without it.", look};
    default:
      return nothing;
  }
}

}  // namespace

std::string separating_text(const std::optional<SeparatingMeasurement>& m) {
  if (!m) return "nothing was fitted that a further measurement could distinguish";
  return fmt::format(
      "{} and {} differ most at gauge {} at about {}, by {:.2g} {} ({:.2g} standard deviations of the errors there); more pulses, or a second gauge beside it, "
      "would distinguish them best",
      m->first, m->second.empty() ? "the base model" : m->second, m->gauge, time_text(m->time), m->difference, m->unit, m->standard_deviations);
}

std::string missing_sentence(const MissingTerms& m) {
  if (m.terms.empty())
    return fmt::format("None of {} simple terms, each in a part of the mercury or on a stretch of a wall, would reproduce the missing effect.", m.screened);
  std::vector<std::string> all;
  for (const auto& t : m.terms) all.push_back(fmt::format("of {} by {} {}", t.what, plain_term(t), t.place));
  const std::string change = fmt::format("What is missing acts like a change {}.", listed(all)), with = all.size() == 1 ? "it" : "them";
  if (!(m.misfit_before > 0)) return change + " This was estimated for a small effect, and the run with " + with + " failed: take it as a hint.";
  const std::string after = percent(m.misfit_after), before = percent(m.misfit_before);
  if (m.misfit_after < m.misfit_before)
    return change + fmt::format(" A run with {} has a misfit of {}, and the base model has {}. This describes an effect and its place; it names no cause.",
                                with, after, before);
  return change + fmt::format(
                      " This was estimated for a small effect: a run with {} has a misfit of {}, and the base model has {}. Take it as a hint of the "
                      "place at most.",
                      with, after, before);
}

namespace {

/// The sentences of a verdict by its kind, as if every fit had settled and the data were in order.
PlainSummary summary_by_kind(const Diagnosis& d, std::span<const ParameterGroup> groups, const Gates& gates) {
  const VerdictMisfits& m = d.misfits;
  switch (d.verdict.kind) {
    case VerdictKind::none:
      return {
          fmt::format("The simulation explains these records within their known errors (misfit {}). They show no effect that was left out.", percent(m.before)),
          "Calibrate with the model as it is. More pulses, or gauges whose places are better known, would show smaller effects."};
    case VerdictKind::named:
      return named_summary(*d.named(), groups, m);
    case VerdictKind::ambiguous: {
      std::vector<std::string> all;
      for (const auto& name : d.verdict.mechanisms) all.push_back(with_key(*d.alternative(name), groups));
      return {
          fmt::format("The simulation leaves something out, and these records do not show whether it is {}. With the first of them the misfit of the records "
                      "goes from {} to {}.",
                      listed(all, "or"), percent(m.before), percent(m.after)),
          "To distinguish them: " + separating_text(d.separating) + '.'};
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
  const std::string kept = "The runs that were made are kept.";
  if (d.verdict.mechanisms.empty() && unsettled[0] != "base") {
    const bool fitted = d.alternative(unsettled[0])->explanation.fitted;
    summary.finding = fitted ? fmt::format(
                                   "The simulation and the records differ. The nearest explanation, {}, leaves a part of the difference. No runs were "
                                   "left to look for a second effect beside it.",
                                   fits[0])
                             : fmt::format(
                                   "The simulation and the records differ. The nearest explanation to first order, {}, was not fitted, because no runs "
                                   "were left.",
                                   fits[0]);
    summary.next_step = "Run the diagnosis again with --fresh and more runs (diagnosis.max_runs). " + kept;
    return;
  }
  summary.next_step =
      fmt::format("Do not act on this yet, because the fit of {} has not settled. Run the diagnosis again with --fresh and {}. {}", listed(fits),
                  d.budget_exhausted ? "more runs (diagnosis.max_runs)" : "more rounds, or more runs a round (emulator.rounds, emulator.round_fine)", kept);
}

/// Changes the sentences where the data are not in order, because nothing else can be done before.
void add_data_checks(const Diagnosis& d, PlainSummary& summary) {
  if (!d.base.mislabelled.empty())
    summary.finding = fmt::format("The simulation and the records differ (misfit {}), but channels appear to be mixed up, so no mechanism was tried.",
                                  percent(d.misfits.before));
  std::string checks;
  for (const auto& channel : d.base.mislabelled) checks += mislabelled_sentence(channel) + ' ';
  if (d.clock) checks += clock_sentence(*d.clock) + ' ';
  if (!checks.empty()) summary.next_step = checks + "Then run the diagnosis again. Until the data are in order, no verdict on physics holds.";
  if (!d.dead.empty()) summary.next_step += ' ' + dead_gauges_sentence(d.dead);
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
  text.base_fit = settling_text(d.base.fit.settling());
  if (!d.missing) return text;
  text.missing = missing_sentence(*d.missing);
  for (const auto& term : d.missing->terms) text.missing_terms.push_back(plain_term(term));
  return text;
}

}  // namespace calomel
