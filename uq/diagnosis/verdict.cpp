#include "uq/diagnosis/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "base/log_sum.hpp"

namespace calomel {

namespace {

const char* base_fits = "the base model explains the records within their errors";

/// Evidence of those scales by themselves that belong, as said by a function of the scale.
template <class Belongs>
double log_part(const EvidenceByScale& e, const Belongs& belongs) {
  std::vector<double> logs, weights;
  double total = 0;
  for (const auto& s : e)
    if (belongs(s.scale)) logs.push_back(s.log_evidence), weights.push_back(s.weight), total += s.weight;
  return logs.empty() ? -std::numeric_limits<double>::infinity() : log_sum(logs, weights) - std::log(total);
}

/// Of the square of a misfit, what is gone.
double share_gone(double after, double before) { return 1 - after * after / (before * before); }

/// Probabilities of the explanations before the records, over that of all names together: singles share alike, and each pair has what it would if all there
/// could be were there.
std::vector<double> priors_of(const std::vector<Explanation>& all, const Gates& g) {
  const auto is_pair = [](const Explanation& e) { return e.name.find('+') != std::string::npos; };
  const double fitted = double(std::count_if(all.begin(), all.end(), is_pair)), singles = double(all.size()) - fitted,
               pairs = std::max(1.0, singles * (singles - 1) / 2);
  std::vector<double> out;
  for (const auto& e : all) out.push_back(is_pair(e) ? g.prior_pairs / pairs : (fitted > 0 ? 1 - g.prior_pairs : 1) / singles);
  return out;
}

void most_probable_first(std::vector<Ranked>& ranking) {
  std::stable_sort(ranking.begin(), ranking.end(), [](const auto& a, const auto& b) { return a.probability > b.probability; });
}

/// Probabilities by the tempered evidences. "None" claims that nothing is left out, a name that what it leaves is small beside what it accounts for; whatever
/// needs more of a discrepancy, the base model or an explanation, is "unknown": half of what that has before the records is the base model's.
std::vector<Ranked> ranked(const BaseEvidence& base, const std::vector<Explanation>& all, const Gates& g) {
  const std::vector<double> of_name = priors_of(all, g);
  const double of_names = 1 - g.prior_none - g.prior_unknown, of_base = all.empty() ? 1 : 0.5;
  const double left = greatest_remainder(base, g);
  std::vector<double> unknown{log_beyond(base.by_scale, 0)}, weights{of_base}, logs, priors;
  if (base.local) weights[0] = 0.5 * of_base, unknown.push_back(*base.local), weights.push_back(0.5 * of_base);
  for (std::size_t i = 0; i < all.size(); ++i) unknown.push_back(log_beyond(all[i].by_scale, left)), weights.push_back((1 - of_base) * of_name[i]);
  std::vector<Ranked> out{{"none", g.prior_none, log_within(base.by_scale, 0)}, {"unknown", g.prior_unknown, log_sum(unknown, weights)}};
  for (std::size_t i = 0; i < all.size(); ++i) out.push_back({all[i].name, of_names * of_name[i], evidence_of_name(base, all[i], g)});
  for (const auto& r : out) logs.push_back(r.log_evidence / g.temperature), priors.push_back(r.probability);
  for (auto& x : unknown) x /= g.temperature;
  logs[1] = log_sum(unknown, weights);
  const auto probabilities = shares(logs, priors);
  for (std::size_t i = 0; i < out.size(); ++i) out[i].probability = probabilities[i];
  most_probable_first(out);
  return out;
}

/// Whether the gate says of an explanation that it is not what the target does, and not only that the records do not tell.
bool refuses(Gate gate) {
  switch (gate) {
    case Gate::explained:
    case Gate::remainder:
    case Gate::misfit:
    case Gate::held_out:
    case Gate::plausible:
    case Gate::handbook:
      return true;
    default:
      return false;
  }
}

/// The evidence of what is refused speaks for something that acts alike and was not offered: its probability is that of "unknown", behind which it stands.
void count_as_unknown(const std::vector<std::string>& refused, std::vector<Ranked>& ranking) {
  const auto is_refused = [&](const Ranked& r) { return std::find(refused.begin(), refused.end(), r.name) != refused.end(); };
  const auto first = std::stable_partition(ranking.begin(), ranking.end(), [&](const Ranked& r) { return !is_refused(r); });
  std::vector<Ranked> behind(first, ranking.end());
  ranking.erase(first, ranking.end());
  const auto is_unknown = [](const Ranked& r) { return r.name == "unknown"; };
  auto& unknown = std::find_if(ranking.begin(), ranking.end(), is_unknown)->probability;
  for (auto& r : behind) unknown += std::exchange(r.probability, 0);
  most_probable_first(ranking);
  ranking.insert(std::find_if(ranking.begin(), ranking.end(), is_unknown) + 1, behind.begin(), behind.end());
}

}  // namespace

double log_within(const EvidenceByScale& e, double scale) {
  return log_part(e, [&](double s) { return s <= scale; });
}

double log_beyond(const EvidenceByScale& e, double scale) {
  return log_part(e, [&](double s) { return s > scale; });
}

double mean_scale(const EvidenceByScale& e) {
  std::vector<double> logs, weights;
  for (const auto& s : e) logs.push_back(s.log_evidence), weights.push_back(s.weight);
  const auto share = shares(logs, weights);
  double mean = 0;
  for (std::size_t i = 0; i < e.size(); ++i) mean += share[i] * e[i].scale;
  return mean;
}

double evidence_of_name(const BaseEvidence& base, const Explanation& e, const Gates& gates) { return log_within(e.by_scale, greatest_remainder(base, gates)); }

void sort_by_evidence(const BaseEvidence& base, std::vector<Explanation>& all, const Gates& gates) {
  std::stable_sort(all.begin(), all.end(), [&](const auto& a, const auto& b) { return evidence_of_name(base, a, gates) > evidence_of_name(base, b, gates); });
}

double least_explained(const Gates& gates) { return 1 - gates.remainder * gates.remainder; }

double greatest_remainder(const BaseEvidence& base, const Gates& gates) {
  const double plausible = greatest_plausible(base, gates), beyond = base.chi2 > plausible ? base.misfit * std::sqrt(1 - plausible / base.chi2) : 0;
  return gates.remainder * std::max(mean_scale(base.by_scale), beyond);  // a discrepancy that no scale can stand for has no scale that is likely
}

std::string text(VerdictKind kind) {
  switch (kind) {
    case VerdictKind::none:
      return "none";
    case VerdictKind::named:
      return "named";
    case VerdictKind::ambiguous:
      return "ambiguous";
    case VerdictKind::unknown:
      return "unknown";
  }
  return "unknown";
}

bool same_class(const Explanation& a, const Explanation& b) {
  return std::find(a.same_as.begin(), a.same_as.end(), b.name) != a.same_as.end() || std::find(b.same_as.begin(), b.same_as.end(), a.name) != b.same_as.end();
}

double greatest_plausible(const BaseEvidence& base, const Gates& gates) {
  return boost::math::quantile(boost::math::complement(boost::math::chi_squared(base.values), gates.adequate));
}

std::optional<double> share_explained(const BaseEvidence& base, const Explanation& e, const Gates& gates) {
  const double before = e.base_chi2.value_or(base.chi2), excess = before - gates.null_chi2 * base.values;
  if (!(excess > 0)) return {};
  return std::clamp((before - e.chi2) / excess, 0.0, 1.0);
}

namespace {

/// Whether the records do not tell two physical explanations apart, by what they predict or by their evidence.
bool not_told_apart(const BaseEvidence& base, const Explanation& a, const Explanation& b, const Gates& g) {
  return same_class(a, b) || (!a.numerical && !b.numerical && std::abs(evidence_of_name(base, a, g) - evidence_of_name(base, b, g)) < g.lead);
}

/// Of the square of the misfit of what was left out of the fit, what is gone with it: of gauges, of many small numbers of the beginning of the records as much.
/// Nothing where nothing was left out.
std::optional<double> share_foretold(const BaseEvidence& base, const Explanation& e) {
  if (!e.foretold) return e.held_out ? std::optional(share_gone(*e.held_out, base.held_out)) : std::nullopt;
  const double beginning = share_gone(e.foretold->beginning, e.foretold->beginning_before);
  return e.held_out ? 0.5 * (beginning + share_gone(*e.held_out, e.foretold->gauges_before)) : beginning;
}

/// A numerical alternative that explains as much as a physical explanation, or more: no record tells the two apart, or its evidence is not behind by the lead
/// that a name needs. Null: there is none.
const Explanation* numerical_rival(const BaseEvidence& base, const std::vector<Explanation>& all, const Explanation& e, const Gates& g) {
  const double own = evidence_of_name(base, e, g);
  const auto at = std::find_if(all.begin(), all.end(),
                               [&](const auto& x) { return x.numerical && &x != &e && (same_class(e, x) || own - evidence_of_name(base, x, g) < g.lead); });
  return at == all.end() ? nullptr : &*at;
}

}  // namespace

double probability_told(const BaseEvidence& base, const std::vector<Explanation>& all, std::size_t i, const Gates& g) {
  double sum = 0;
  for (const auto& r : ranked(base, all, g))
    for (const auto& e : all)
      if (e.name == r.name && (&e == &all[i] || not_told_apart(base, all[i], e, g))) sum += r.probability;
  return sum;
}

Gate gate_not_passed(const BaseEvidence& base, const std::vector<Explanation>& all, std::size_t i, const Gates& g) {
  const Explanation& e = all[i];
  if (e.log_bayes_factor < g.log_bayes_factor) return e.fitted ? Gate::evidence : Gate::fitted;
  if (e.numerical) return Gate::numerical;
  const double own = evidence_of_name(base, e, g);
  if (i > 0 && !same_class(all[0], e) && evidence_of_name(base, all[0], g) - own >= g.lead) return Gate::rival;
  if (numerical_rival(base, all, e, g)) return Gate::numerical_rival;
  if (!e.fitted) return Gate::fitted;
  const double share = share_explained(base, e, g).value_or(0);
  const double plausible = greatest_plausible(base, g);
  if (e.chi2 > plausible && (e.of_two || share < least_explained(g))) return share < g.explained ? Gate::explained : Gate::remainder;
  // Of the records themselves a base model that bends its parameters to them may have the smaller misfit; what was left out of both fits tells which of them
  // predicts.
  const auto foretold = share_foretold(base, e);
  if (!foretold && !(e.misfit < g.misfit * base.misfit)) return Gate::misfit;
  const double of_records = share_gone(e.misfit, e.foretold ? e.foretold->misfit_before : base.misfit);
  if (foretold && !(*foretold > (e.of_a_gauge ? 0 : g.held_out * std::max(0.0, of_records)))) return Gate::held_out;
  if (e.farthest > g.farthest) return Gate::plausible;
  if (e.base_pull > std::max(base.base_pull, g.handbook)) return Gate::handbook;
  if (probability_told(base, all, i, g) <= g.believed) return Gate::probability;
  return Gate::passed;
}

Verdict judge(const BaseEvidence& base, std::vector<Explanation> all, const Gates& g) {
  sort_by_evidence(base, all, g);
  Verdict v;
  v.ranking = ranked(base, all, g);
  const bool base_adequate = base.chi2 <= greatest_plausible(base, g);
  const auto otherwise = [&](const std::string& why) {
    v.kind = base_adequate ? VerdictKind::none : VerdictKind::unknown;
    v.reason = base_adequate
                   ? fmt::format("{} (chi-squared {:.4g} for {:.0f} values)", base_fits, base.chi2, base.values)
                   : fmt::format("the base model does not explain the records (chi-squared {:.4g} for {:.0f} values), and {}", base.chi2, base.values, why);
    return v;
  };
  const auto unknown = [&](const std::string& why) {
    v.kind = VerdictKind::unknown, v.reason = why;
    return v;
  };
  if (all.empty()) return otherwise("nothing was offered that could");
  const Explanation& best = all[0];
  const auto next = std::find_if(all.begin() + 1, all.end(), [&](const auto& e) { return !same_class(best, e); });
  const double own = evidence_of_name(base, best, g), lead = next == all.end() ? own : own - evidence_of_name(base, *next, g),
               explained = share_explained(base, best, g).value_or(0);
  const Gate gate = gate_not_passed(base, all, 0, g);
  if (refuses(gate)) {
    std::vector<std::string> refused;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (refuses(gate_not_passed(base, all, i, g))) refused.push_back(all[i].name);
    count_as_unknown(refused, v.ranking);
  }
  switch (gate) {
    case Gate::fitted:
      if (best.log_bayes_factor >= g.log_bayes_factor)
        return unknown(
            fmt::format("{} comes nearest, with a log Bayes factor of {:.3g} to first order, but was not fitted in the true model: raise diagnosis.leaders or "
                        "diagnosis.max_runs",
                        best.name, best.log_bayes_factor));
      [[fallthrough]];
    case Gate::evidence:
      return otherwise(fmt::format("nothing that was offered does: the best, {}, has a log Bayes factor of {:.3g}, below {:.3g}", best.name,
                                   best.log_bayes_factor, g.log_bayes_factor));
    case Gate::numerical:
      return unknown(fmt::format("numerics: {} explains the records better than any physics that was offered", best.name));
    case Gate::numerical_rival:
      return unknown(fmt::format("numerics: {} explains as much as {}", numerical_rival(base, all, best, g)->name, best.name));
    case Gate::explained:
      return unknown(fmt::format("{} comes nearest, but explains only {:.0f} % of what the base model leaves", best.name, 100 * explained));
    case Gate::remainder:
      return unknown(
          fmt::format("{} comes nearest, but with it the records are still not explained: it leaves {:.0f} % of what the base model leaves (chi-squared {:.4g} "
                      "for {:.0f} values)",
                      best.name, 100 * (1 - explained), best.chi2, base.values));
    case Gate::misfit:
      return unknown(fmt::format("{} has the evidence, but with it the records are not nearer: their misfit is {:.3g} % and was {:.3g} %", best.name,
                                 100 * best.misfit, 100 * base.misfit));
    case Gate::held_out:
      if (best.foretold)
        return unknown(fmt::format(
            "{} has the evidence, but what was left out of the fit gains too little by it: the misfit of {}the first quarter of all records is {:.3g} % and "
            "was {:.3g} %",
            best.name,
            best.held_out ? fmt::format("gauges is {:.3g} % and was {:.3g} %, that of ", 100 * *best.held_out, 100 * best.foretold->gauges_before) : "",
            100 * best.foretold->beginning, 100 * best.foretold->beginning_before));
      return unknown(
          fmt::format("{} has the evidence, but gauges that were left out of the fit gain too little by it: their misfit is {:.3g} % and was {:.3g} %, where "
                      "that of the records is {:.3g} % and was {:.3g} %",
                      best.name, 100 * *best.held_out, 100 * base.held_out, 100 * best.misfit, 100 * base.misfit));
    case Gate::plausible:
      return unknown(fmt::format("{} would explain the records with a number {:.2g} standard deviations beyond what is plausible", best.name, best.farthest));
    case Gate::handbook:
      return unknown(fmt::format("{} would explain the records only with base parameters farther from the handbook than without it", best.name));
    case Gate::probability:
      return unknown(fmt::format("{} comes nearest, but has a probability of {:.0f} % only", best.name, 100 * probability_told(base, all, 0, g)));
    case Gate::rival:
    case Gate::passed:
      break;
  }
  for (const auto& e : all)
    if (&e != &best && not_told_apart(base, best, e, g)) v.mechanisms.push_back(e.name);
  v.mechanisms.insert(v.mechanisms.begin(), best.name);
  v.kind = v.mechanisms.size() == 1 ? VerdictKind::named : VerdictKind::ambiguous;
  v.reason = fmt::format("{} explains {:.0f} % of what the base model leaves (log Bayes factor {:.3g}, lead {:.3g})", best.name, 100 * explained,
                         best.log_bayes_factor, lead);
  return v;
}

}  // namespace calomel
