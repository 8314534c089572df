#include "uq/diagnosis/verdict.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "base/log_sum.hpp"

namespace calomel {

namespace {

/// Log evidence of the scales for which `belongs` is true, as a part by itself.
template <class Belongs>
double log_part(const EvidenceByScale& e, const Belongs& belongs) {
  std::vector<double> logs, weights;
  double total = 0;
  for (const auto& s : e) {
    if (!belongs(s.scale)) continue;
    logs.push_back(s.log_evidence);
    weights.push_back(s.weight);
    total += s.weight;
  }
  return logs.empty() ? -std::numeric_limits<double>::infinity() : log_sum(logs, weights) - std::log(total);
}

/// Share of the square of a misfit that is gone.
double share_gone(double after, double before) { return 1 - after * after / (before * before); }

/// Prior probabilities of the explanations over that of all names together. Single mechanisms share alike; a pair has the share of one of all pairs that the
/// single mechanisms could form.
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

/// Probabilities by the tempered evidences. "None" claims that nothing is left out, a name that it leaves little beside what it accounts for. The base model or
/// an explanation that needs more of a discrepancy is "unknown"; half of the prior probability of "unknown" is that of the base model.
std::vector<Ranked> ranked(const BaseEvidence& base, const std::vector<Explanation>& all, const Gates& g) {
  const std::vector<double> of_name = priors_of(all, g);
  const double of_names = 1 - g.prior_none - g.prior_unknown, of_base = all.empty() ? 1 : 0.5;
  const double left = greatest_remainder(base, g);
  std::vector<double> unknown{log_beyond(base.by_scale, 0)}, weights{of_base}, logs, priors;
  if (base.local) {
    weights[0] = 0.5 * of_base;
    unknown.push_back(*base.local);
    weights.push_back(0.5 * of_base);
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    unknown.push_back(log_beyond(all[i].by_scale, left));
    weights.push_back((1 - of_base) * of_name[i]);
  }
  std::vector<Ranked> out{{"none", g.prior_none, log_within(base.by_scale, 0)}, {"unknown", g.prior_unknown, log_sum(unknown, weights)}};
  for (std::size_t i = 0; i < all.size(); ++i) out.push_back({all[i].name, of_names * of_name[i], evidence_of_name(base, all[i], g)});
  for (const auto& r : out) {
    logs.push_back(r.log_evidence / g.temperature);
    priors.push_back(r.probability);
  }
  for (auto& x : unknown) x /= g.temperature;
  logs[1] = log_sum(unknown, weights);
  const auto probabilities = shares(logs, priors);
  for (std::size_t i = 0; i < out.size(); ++i) out[i].probability = probabilities[i];
  most_probable_first(out);
  return out;
}

/// Whether an explanation that fails the gate is not what the target does, rather than only not shown by the records.
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

/// Adds the probabilities of refused explanations to that of "unknown" and puts them behind it. Their evidence speaks for something that acts alike and was not
/// offered.
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
  for (const auto& s : e) {
    logs.push_back(s.log_evidence);
    weights.push_back(s.weight);
  }
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
  const double plausible = greatest_plausible(base, gates);
  const double beyond_errors = base.chi2 > plausible ? base.misfit * std::sqrt(1 - plausible / base.chi2) : 0;
  return gates.remainder * std::max(mean_scale(base.by_scale), beyond_errors);  // no scale is likely where the misfit is larger than all of them
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

/// Whether the records do not distinguish two physical explanations, by their predictions or by their evidence.
bool indistinguishable(const BaseEvidence& base, const Explanation& a, const Explanation& b, const Gates& g) {
  return same_class(a, b) || (!a.numerical && !b.numerical && std::abs(evidence_of_name(base, a, g) - evidence_of_name(base, b, g)) < g.lead);
}

/// Share of the squared misfit of held-out records that is gone with an explanation: of gauges, and for many small numbers the mean of gauges and the beginning
/// of the records. Nothing where nothing was held out.
std::optional<double> share_predicted(const BaseEvidence& base, const Explanation& e) {
  const auto& prediction = e.hold_out_prediction;
  if (!prediction) return e.held_out ? std::optional(share_gone(*e.held_out, base.held_out)) : std::nullopt;
  const double beginning = share_gone(prediction->beginning, prediction->beginning_before);
  return e.held_out ? 0.5 * (beginning + share_gone(*e.held_out, prediction->gauges_before)) : beginning;
}

/// A numerical alternative that explains as much as a physical explanation, or more: no record distinguishes the two, or its evidence is behind by less than
/// the lead that a name needs. Null: there is none.
const Explanation* numerical_competitor(const BaseEvidence& base, const std::vector<Explanation>& all, const Explanation& e, const Gates& g) {
  const double own = evidence_of_name(base, e, g);
  const auto at = std::find_if(all.begin(), all.end(),
                               [&](const auto& x) { return x.numerical && &x != &e && (same_class(e, x) || own - evidence_of_name(base, x, g) < g.lead); });
  return at == all.end() ? nullptr : &*at;
}

}  // namespace

double class_probability(const BaseEvidence& base, const std::vector<Explanation>& all, std::size_t i, const Gates& g) {
  double sum = 0;
  for (const auto& r : ranked(base, all, g))
    for (const auto& e : all)
      if (e.name == r.name && (&e == &all[i] || indistinguishable(base, all[i], e, g))) sum += r.probability;
  return sum;
}

Gate gate_not_passed(const BaseEvidence& base, const std::vector<Explanation>& all, std::size_t i, const Gates& g) {
  const Explanation& e = all[i];
  if (e.log_bayes_factor < g.log_bayes_factor) return e.fitted ? Gate::evidence : Gate::fitted;
  if (e.numerical) return Gate::numerical;
  const double own = evidence_of_name(base, e, g);
  if (i > 0 && !same_class(all[0], e) && evidence_of_name(base, all[0], g) - own >= g.lead) return Gate::competitor;
  if (numerical_competitor(base, all, e, g)) return Gate::numerical_competitor;
  if (!e.fitted) return Gate::fitted;
  const double share = share_explained(base, e, g).value_or(0);
  const double plausible = greatest_plausible(base, g);
  if (e.chi2 > plausible && (e.of_two || share < least_explained(g))) return share < g.explained ? Gate::explained : Gate::remainder;
  // A base model that bends its parameters to the records may have the smaller misfit with them. Records that were held out of both fits show which of the two
  // predicts.
  const auto predicted = share_predicted(base, e);
  if (!predicted && !(e.misfit < g.misfit * base.misfit)) return Gate::misfit;
  const double of_records = share_gone(e.misfit, e.hold_out_prediction ? e.hold_out_prediction->misfit_before : base.misfit);
  if (predicted && !(*predicted > (e.of_a_gauge ? 0 : g.held_out * std::max(0.0, of_records)))) return Gate::held_out;
  if (e.farthest > g.farthest) return Gate::plausible;
  if (e.base_prior_deviation > std::max(base.base_prior_deviation, g.handbook)) return Gate::handbook;
  if (class_probability(base, all, i, g) <= g.believed) return Gate::probability;
  return Gate::passed;
}

Verdict judge(const BaseEvidence& base, std::vector<Explanation> all, const Gates& g) {
  sort_by_evidence(base, all, g);
  Verdict v;
  v.ranking = ranked(base, all, g);
  VerdictReason& reason = v.reason;
  reason.base_adequate = base.chi2 <= greatest_plausible(base, g);
  const VerdictKind nothing_shown = reason.base_adequate ? VerdictKind::none : VerdictKind::unknown;
  if (all.empty()) {
    v.kind = nothing_shown;
    return v;
  }
  const Explanation& best = all[0];
  const auto next = std::find_if(all.begin() + 1, all.end(), [&](const auto& e) { return !same_class(best, e); });
  const double own = evidence_of_name(base, best, g);
  reason.leading = best.name;
  reason.lead = next == all.end() ? own : own - evidence_of_name(base, *next, g);
  reason.explained = share_explained(base, best, g).value_or(0);
  reason.gate = gate_not_passed(base, all, 0, g);
  if (refuses(reason.gate)) {
    std::vector<std::string> refused;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (refuses(gate_not_passed(base, all, i, g))) refused.push_back(all[i].name);
    count_as_unknown(refused, v.ranking);
  }
  if (reason.gate == Gate::numerical_competitor) reason.numerical_competitor = numerical_competitor(base, all, best, g)->name;
  if (reason.gate == Gate::probability) reason.probability = class_probability(base, all, 0, g);
  if (reason.gate == Gate::evidence || (reason.gate == Gate::fitted && best.log_bayes_factor < g.log_bayes_factor)) {
    v.kind = nothing_shown;
    return v;
  }
  if (reason.gate != Gate::passed && reason.gate != Gate::competitor) {
    v.kind = VerdictKind::unknown;
    return v;
  }
  for (const auto& e : all)
    if (&e != &best && indistinguishable(base, best, e, g)) v.mechanisms.push_back(e.name);
  v.mechanisms.insert(v.mechanisms.begin(), best.name);
  v.kind = v.mechanisms.size() == 1 ? VerdictKind::named : VerdictKind::ambiguous;
  return v;
}

}  // namespace calomel
