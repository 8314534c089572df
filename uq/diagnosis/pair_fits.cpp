#include "uq/diagnosis/pair_fits.hpp"

#include <algorithm>
#include <set>

#include "uq/diagnosis/explanation_fit.hpp"
#include "uq/diagnosis/leading_fits.hpp"
#include "uq/diagnosis/linearised_fit.hpp"

namespace calomel {

namespace {

/// The explanation to which others are added; null where there is none.
const Alternative* first_of_pair(const FitLibrary& library, const Verdict& verdict) {
  const bool named = verdict.kind == VerdictKind::named;
  const auto may_be_first = [&](const Alternative& c, bool gauges) {
    const bool fitted = library.fits.contains(c.explanation.name) && !c.explanation.numerical;
    return fitted && (gauges || c.sensor.empty()) && c.explanation.log_bayes_factor >= (gauges ? least_to_fit : Gates{}.log_bayes_factor);
  };
  for (const auto& c : library.candidates)
    if (may_be_first(c, false) && (!named || c.explanation.name == verdict.mechanisms[0])) return &c;
  for (const auto& c : library.candidates)
    if (!named && may_be_first(c, true)) return &c;
  return nullptr;
}

}  // namespace

bool fit_pairs(const FitContext& context, const Verdict& verdict) {
  const DiagnosisInputs& in = context.in;
  FitLibrary& library = context.library;
  const bool named = verdict.kind == VerdictKind::named;
  if (!named && verdict.kind != VerdictKind::unknown) return false;
  const Alternative* first = first_of_pair(library, verdict);
  if (!first) return false;
  const Alternative below = *first;
  const ExplanationFit& fit = library.fits.at(below.explanation.name);
  const auto includes = [&](const ParameterGroup& g) { return g.name != below.groups[0] && (!named || g.by_sensor || !g.sensor.empty()); };
  if (named && std::none_of(in.groups.begin(), in.groups.end(), includes)) return false;
  in.say(ScreeningBegins{.on_top_of = below.explanation.name, .gauges_alone = named});
  ScreeningInputs screening = screening_about(in, context.budget, fit.fit, fit.added, in.groups);
  screening.includes = includes;
  auto screened = screen_candidates(screening).candidates;
  // Several are fitted where runs are cheap, gauges last, because the first order is inaccurate about a fit that already explains much.
  const bool cheap = in.base.box.by_least_squares() && !named;
  if (cheap) std::stable_partition(screened.begin(), screened.end(), [&](const auto& c) { return in.groups[c.group].sensor.empty(); });
  const std::size_t most = cheap ? std::size_t(in.options.leaders) : 1;
  const double least = named ? Gates{}.log_bayes_factor : least_to_fit;
  std::set<std::string> tried;
  for (const auto& candidate : screened) {
    const ParameterGroup& group = in.groups[candidate.group];
    if (group.numerical || !tried.insert(group.name).second) continue;
    if (tried.size() > most || (!cheap && candidate.first_order.log_bayes_factor < least)) break;
    in.say(CandidateScreened{.label = label(candidate, in.groups, in.base.problem.shape),
                             .log_bayes_factor = candidate.first_order.log_bayes_factor,
                             .p_value = candidate.p_value,
                             .on_top = true});
    const double best = library.best_log_bayes_factor();
    auto pair = candidate.sensor ? fit_gauge_fault(context, group, candidate, &below, best)
                : group.linear   ? fit_linearised(context, group, candidate, &below, best)
                                 : fit_explanation(context, group, candidate, &below, best);
    if (pair) library.candidates.push_back(std::move(*pair));
  }
  return true;
}

}  // namespace calomel
