#include "uq/diagnosis/plain_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace calomel {

namespace {

constexpr double hardly = 3;  ///< log Bayes factor up to which nothing speaks for an explanation

std::string percent(double share) { return fmt::format("{:.{}f} %", 100 * share, 100 * share < 9.95 ? 1 : 0); }

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

/// Where the mismatch is first seen, else where it is greatest.
std::string where(const LocatedMismatch& l) {
  if (!l.first_sensor.empty())
    return l.first_time > 0 ? fmt::format("at gauge {} from {} on, where the mismatch is first seen", l.first_sensor, time_text(l.first_time))
                            : fmt::format("at gauge {}, which shows the mismatch from the start", l.first_sensor);
  const auto most = std::max_element(l.sensors.begin(), l.sensors.end(), [](const auto& a, const auto& b) { return a.score < b.score; });
  return most == l.sensors.end() ? "at the gauges with the greatest mismatch" : "at gauge " + most->name + ", where the mismatch is greatest";
}

/// ", and on gauges that were left out of the fit from 12 % to 6.0 %"; says so where it does not fall. Empty where no gauge was left out.
std::string held_out_part(const Alternative& a, const Misfits& m) {
  if (a.held_out.empty() || !(m.held_out_before > 0)) return "";
  const std::string from_to = fmt::format("{} to {}", percent(m.held_out_before), percent(m.held_out_after));
  return m.held_out_after < m.held_out_before ? ", and on " + m.held_out + " that were left out of the fit from " + from_to
                                              : ", but on " + m.held_out + " that were left out of the fit it does not fall (" + from_to + ")";
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

/// What becomes of the misfit with it. That of the records that were fitted may rise: without it the base parameters had bent to them.
std::string misfit_part(const Alternative& a, const Misfits& m) {
  if (m.after < m.before || a.held_out.empty() || m.held_out_after >= m.held_out_before)
    return fmt::format("the misfit of the records {} from {} to {}{}", m.after < m.before ? "falls" : "goes", percent(m.before), percent(m.after),
                       held_out_part(a, m));
  return fmt::format(
      "the misfit of {} that were left out of the fit falls from {} to {} (that of the records that were fitted goes from {} to {}: without it the base "
      "parameters had bent to them)",
      m.held_out, percent(m.held_out_before), percent(m.held_out_after), percent(m.before), percent(m.after));
}

/// Both sentences of a verdict that names one thing.
PlainSummary named_summary(const Alternative& a, std::span<const ParameterGroup> groups, const Misfits& m) {
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

PlainSummary unknown_summary(const Diagnosis& d, std::span<const ParameterGroup> groups, const Misfits& m, const Gates& gates) {
  const std::string misfit = fmt::format("(misfit {})", percent(m.before));
  const bool one_place = d.evidence.local && *d.evidence.local > gates.lead;
  const std::string alone = !one_place                     ? ""
                            : d.likeliest_place.size() > 1 ? fmt::format(" (it shows near gauges {} alone)", listed(d.likeliest_place))
                                                           : fmt::format(" (it shows near gauge {} alone: see whether it reads true)", d.likeliest_place[0]);
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
  switch (gate_not_passed(d.evidence, all, 0, gates)) {
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
      return {
          begin + fmt::format(" comes nearest, but accounts for only {:.0f} % of the mismatch.", 100 * share_explained(d.evidence, all[0], gates).value_or(0)),
          look};
    case Gate::remainder:
      return {begin + " comes nearest, but with it the records are still not explained.", look};
    case Gate::probability:
      return {begin + fmt::format(" comes nearest, with a probability of {:.0f} %, which is not enough for a name.",
                                  100 * probability_told(d.evidence, all, 0, gates)),
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
  const bool adequate = d.evidence.chi2 <= greatest_plausible(d.evidence, gates);
  const std::string chi2 = chi2_words(d.evidence.chi2, d.evidence, gates);
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

/// Of an explanation that is stopped by Gate::explained or Gate::remainder.
Why why_it_leaves_too_much(const Diagnosis& d, const Explanation& e, const Gates& g) {
  const double share = share_explained(d.evidence, e, g).value_or(0), left = 100 - 100 * share;
  const std::string chi2 = chi2_words(e.chi2, d.evidence, g), second = "A second effect beside it that accounts for the rest.";
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

std::string separating_measurement(const Diagnosis& d, const Problem& problem) {
  std::vector<const Alternative*> two;  // those that are not told apart, and then those that come next
  const auto take = [&](const std::string& name) {
    const Alternative* c = d.alternative(name);
    if (!c->history.empty() && two.size() < 2 && std::find(two.begin(), two.end(), c) == two.end()) two.push_back(c);
  };
  for (const auto& name : d.verdict.mechanisms) take(name);
  for (const auto& e : d.by_evidence()) take(e.name);
  if (two.empty()) return "nothing was fitted that a further measurement could tell apart";
  const auto values = [](const std::vector<double>& v) { return Eigen::Map<const Eigen::VectorXd>(v.data(), Eigen::Index(v.size())); };
  const Decimation& grid = d.base.errors->grid();
  const Eigen::VectorXd difference = grid.apply(values(two[0]->history) - values(two.size() > 1 ? two[1]->history : d.base_history));
  const Eigen::VectorXd z = difference.cwiseQuotient(d.base.errors->covariance().diagonal().cwiseSqrt());
  Eigen::Index most = 0;
  z.cwiseAbs().maxCoeff(&most);
  std::size_t at = 0;
  while (at + 1 < grid.observations() && Eigen::Index(grid.offset(at + 1)) <= most) ++at;
  return fmt::format(
      "{} and {} differ most at gauge {} about {}, by {:.2g} {} ({:.2g} standard deviations of its mean record and what is not known of it): more pulses, or a "
      "second gauge beside it, tell most there",
      two[0]->explanation.name, two.size() > 1 ? two[1]->explanation.name : "the base model", problem.label(problem.observations[at]),
      time_text(grid.times()[most]), problem.mae_scale * std::abs(difference[most]), problem.mae_unit, std::abs(z[most]));
}

Why why(const Diagnosis& d, const std::string& name, std::span<const ParameterGroup> groups, const Gates& g) {
  const Alternative* a = d.alternative(name);
  if (!a) return why_of_base(d, name, g);
  const auto all = d.by_evidence();
  const auto at = std::size_t(std::find_if(all.begin(), all.end(), [&](const auto& e) { return e.name == name; }) - all.begin());
  const Explanation& e = all[at];
  const double share = 100 * share_explained(d.evidence, e, g).value_or(0), b = e.log_bayes_factor;
  const Alternative& best = *d.alternative(all[0].name);
  const auto& told = d.verdict.mechanisms;
  if (std::find(told.begin(), told.end(), name) != told.end()) {
    if (d.verdict.kind == VerdictKind::named) {
      const auto next = std::find_if(all.begin(), all.end(), [&](const auto& x) { return x.name != name && !same_class(e, x); });
      const std::string behind = next == all.end()
                                     ? "nothing else was tried"
                                     : fmt::format("the evidence of the next, {}, lies {:.3g} below its own", plain_name(*d.alternative(next->name), groups),
                                                   evidence_of_name(d.evidence, e, g) - evidence_of_name(d.evidence, *next, g));
      return {fmt::format("Named: it accounts for {:.0f} % of the mismatch with a log Bayes factor of {:.3g}, and {}.", share, b, behind),
              fmt::format("Another explanation whose evidence comes within {:.0f} of it, or a record that it does not fit.", g.lead)};
    }
    std::vector<std::string> others;
    for (const auto& other : told)
      if (other != name) others.push_back(plain_name(*d.alternative(other), groups));
    return {fmt::format("May be it: it accounts for {:.0f} % of the mismatch (log Bayes factor {:.3g}), but {} cannot be told apart from it by these records.",
                        share, b, listed(others)),
            "A measurement that tells them apart."};
  }
  switch (gate_not_passed(d.evidence, all, at, g)) {
    case Gate::fitted:
      if (!a->message.empty() && a->message != "to first order") return {"Its fit failed: " + a->message + '.', "A fit that goes through."};
      return {
          a->first_log_bayes_factor > hardly
              ? fmt::format("Looked at to first order only (log Bayes factor {:.3g} there): others promised more and were fitted.", a->first_log_bayes_factor)
              : std::string("Nothing in these records speaks for it."),
          a->first_log_bayes_factor > hardly ? "A fit of its own: raise diagnosis.leaders." : "Records in which its effect shows: other gauges, more pulses."};
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
                          evidence_of_name(d.evidence, all[0], g), evidence_of_name(d.evidence, e, g)),
              fmt::format("Records that speak for it and against {}.", plain_name(best, groups))};
    case Gate::numerical_rival:
      return {"A number of the simulation's discretisation explains the records nearly as well.", "Finer meshes (emulator.element_sizes)."};
    case Gate::explained:
    case Gate::remainder:
      return why_it_leaves_too_much(d, e, g);
    case Gate::misfit:
      return {fmt::format("With it the records are not nearer: their misfit is {}, and {} without it.", percent(e.misfit), percent(d.evidence.misfit)),
              "A fit with it that comes nearer to the records."};
    case Gate::held_out:
      if (const auto& f = e.foretold)
        return {fmt::format("What was left out of the fit gains too little by it: the misfit of {}the first quarter of the records is {}, and {} without it.",
                            e.held_out ? fmt::format("gauges is {}, and {} without it, that of ", percent(*e.held_out), percent(f->gauges_before)) : "",
                            percent(f->beginning), percent(f->beginning_before)),
                "Records that begin before the pulse, and more gauges: what earlier pulses left shows in all of them."};
      return {fmt::format("What was left out of the fit gains too little by it: its misfit is {}, and {} without it.", percent(e.held_out.value_or(0)),
                          percent(d.evidence.held_out)),
              "More gauges, so that a prediction can be held against records."};
    case Gate::plausible:
      return {fmt::format("It would have to be stronger than is plausible ({}).", plain_size(*a, groups)),
              "Knowing by other means that it can be that strong."};
    case Gate::handbook:
      return {"With it the base parameters lie farther from the handbook than without it.", "Handbook values that are known to be other than the priors say."};
    case Gate::probability:
      return {fmt::format("It has a probability of {:.0f} %, where more than {:.0f} % is asked: something else, or with it something more, may be it as well.",
                          100 * probability_told(d.evidence, all, at, g), 100 * g.believed),
              "Records that speak for it and against the others, or a second effect beside it that accounts for the rest."};
    case Gate::passed:
      return {d.verdict.reason.empty() ? std::string("It is not what the verdict names.") : sentence(d.verdict.reason),
              "A record or a measurement that speaks for it alone."};
  }
  return {};
}

std::string plain_term(const MissingTerm& t) {
  const std::string sign = t.value < 0 ? "" : "+";
  if (t.unit.empty()) return sign + with_sd(100 * t.value, 100 * t.sd, "%");
  const auto unit = shown_unit(t.unit, std::max(std::abs(t.value), t.sd));
  return sign + with_sd(unit.factor * t.value, unit.factor * t.sd, unit.name);
}

std::string plain_missing(const MissingTerms& m) {
  if (m.terms.empty())
    return fmt::format("None of {} simple terms, each in a part of the mercury or on a stretch of a wall, would do what is missing.", m.asked);
  std::vector<std::string> all;
  for (const auto& t : m.terms) all.push_back(fmt::format("of {} by {} {}", t.what, plain_term(t), t.place));
  std::string told = fmt::format("What is missing acts like a change {}.", listed(all));
  const std::string with = all.size() == 1 ? "it" : "them";
  if (!(m.misfit_before > 0)) return told + " It holds where the effect is small alone: no run with " + with + " came through. This is a hint, not a name.";
  const std::string compared = fmt::format("a misfit of {}, where the base model leaves {}", percent(m.misfit_after), percent(m.misfit_before));
  if (m.misfit_after < m.misfit_before)
    return told + " With " + with + " a run leaves " + compared + ". This describes an effect and its place; it is not a name.";
  return told + " It holds where the effect is small alone: a run with " + with + " does not come nearer to the records (" + compared +
         "). This is a hint of the place at most, not a name.";
}

std::string plain_mixed_up(const MixedUp& m) {
  if (m.own > 0 && m.other.empty())
    return fmt::format(
        "Gauge {} reads {:.2g} times what the others let expect there, in the course that is simulated (correlation {:.2f}): see to its unit and its gain.",
        m.gauge, m.factor, m.own);
  if (m.other.empty())
    return fmt::format(
        "Gauge {} reads what is simulated there with the other sign (correlation {:.2f}): see whether it is wired the wrong way round, or its direction wrong.",
        m.gauge, m.own);
  return fmt::format(
      "Gauge {} reads what is simulated at {}, and {} what is simulated at {} (correlation {:.2f}, with its own {:.2f}): see whether the two are taken for "
      "each other.",
      m.gauge, m.other, m.other, m.gauge, m.like, m.own);
}

std::string plain_late(const LateRecords& l) {
  const ShownUnit unit = shown_unit("s", std::abs(l.late));
  return fmt::format(
      "All records look {} {} (log Bayes factor {:.3g} to first order): see from which instant they count, and set recordings.trigger_offset, or "
      "errors.trigger_sd where that is not known.",
      with_sd(unit.factor * std::abs(l.late), unit.factor * l.sd, unit.name), l.late > 0 ? "late" : "early", l.log_bayes_factor);
}

PlainSummary plain_summary(const Diagnosis& d, std::span<const ParameterGroup> groups, const Misfits& m, const Gates& gates) {
  PlainSummary told;
  const auto& names = d.verdict.mechanisms;
  switch (d.verdict.kind) {
    case VerdictKind::none:
      told = {fmt::format("The simulation explains these records within what is known of their errors (misfit {}): nothing that they could show was left out.",
                          percent(m.before)),
              "Calibrate with it as it is; more pulses, or gauges whose places are better known, would show smaller effects."};
      break;
    case VerdictKind::named:
      told = named_summary(*d.alternative(names.at(0)), groups, m);
      break;
    case VerdictKind::ambiguous: {
      std::vector<std::string> all;
      for (const auto& name : names) all.push_back(with_key(*d.alternative(name), groups));
      told = {fmt::format("The simulation leaves something out, but these records do not tell whether it is {}: with any one of them the misfit falls, from {} "
                          "to {} with the first.",
                          listed(all, "or"), percent(m.before), percent(m.after)),
              "To tell them apart: " + d.separating + '.'};
      break;
    }
    case VerdictKind::unknown:
      told = unknown_summary(d, groups, m, gates);
      break;
  }
  const auto unsettled = d.unsettled();
  std::vector<std::string> fits;
  for (const auto& name : unsettled) fits.push_back(name == "base" ? "the base model" : with_key(*d.alternative(name), groups));
  if (names.empty() && !fits.empty() && unsettled[0] != "base")
    told = {d.alternative(unsettled[0])->explanation.fitted
                ? fmt::format(
                      "The simulation and the records differ. What comes nearest, {}, leaves a part of it, and no runs were left to look for a second effect "
                      "beside it.",
                      fits[0])
                : fmt::format("The simulation and the records differ, and what comes nearest to first order, {}, was not fitted: no runs were left for it.",
                              fits[0]),
            "Run the diagnosis again with --fresh and more runs (diagnosis.max_runs); those that were made are kept."};
  else if (!fits.empty())
    told.next_step = fmt::format(
        "Do not act on this yet: the fit of {} has not settled, so run the diagnosis again with --fresh and more {}; the runs that were made are kept.",
        listed(fits), d.spent ? "runs (diagnosis.max_runs)" : "rounds, or runs a round (emulator.rounds, emulator.round_fine)");
  if (!d.mixed_up.empty())
    told.finding =
        fmt::format("The simulation and the records differ (misfit {}), but gauges look mixed up: what was left out was not asked.", percent(m.before));
  std::string slips;
  for (const auto& mixed : d.mixed_up) slips += plain_mixed_up(mixed) + ' ';
  if (d.late) slips += plain_late(*d.late) + ' ';
  if (!slips.empty())
    told.next_step = slips + "Then run the diagnosis again: until that is cleared up, no verdict on physics holds.";  // nothing else is worth doing before
  if (!d.dead.empty()) told.next_step += ' ' + plain_dead(d.dead);
  return told;
}

}  // namespace calomel
