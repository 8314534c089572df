#include "uq/diagnosis/leading_fits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "uq/diagnosis/explanation_fit.hpp"
#include "uq/diagnosis/linearised_fit.hpp"

namespace calomel {

namespace {

constexpr std::size_t further_variants = 2;  ///< gauges or laws that are fitted beside the one with the greatest first-order evidence

std::vector<Alternative>::iterator find_candidate(FitLibrary& library, const std::string& name) {
  return std::find_if(library.candidates.begin(), library.candidates.end(), [&](const auto& c) { return c.explanation.name == name; });
}

/// A candidate about one gauge with a group of its own, whose numbers the model can be run with.
struct OwnGroup {
  ParameterGroup group;
  ScreenedCandidate screened;
};

OwnGroup with_own_group(const FitContext& context, const ParameterGroup& group, ScreenedCandidate screened) {
  if (!screened.sensor) return {group, std::move(screened)};
  ParameterGroup own = of_one_sensor(group, context.in.base.problem.shape.sensors[*screened.sensor]);
  screened.sensor.reset();
  return {std::move(own), std::move(screened)};
}

/// Whether a linearised fault of a gauge needs no fit of its own.
bool explains_all(const FitContext& context, const Alternative& a) {
  const Explanation& e = a.explanation;
  return a.settled && std::isfinite(e.farthest) && e.log_bayes_factor > least_to_fit && e.chi2 < greatest_plausible(context.base.evidence);
}

/// Fits the gauge with the greatest evidence, in place of its fault to first order.
void fit_leading_gauge(const FitContext& context, const ParameterGroup& group, const ScreenedCandidate& screened) {
  FitLibrary& library = context.library;
  const auto linear = find_candidate(library, group.name);
  if (linear == library.candidates.end()) return;
  auto fitted = fit_gauge_fault(context, group, screened, nullptr, library.best_log_bayes_factor());
  if (fitted && fitted->explanation.fitted) *linear = std::move(*fitted);
}

/// Fits a candidate that is one of several variants of its mechanism: the gauge that may be at fault, or one of several laws. Variants that could be as likely
/// are fitted, too, and the best is kept. Two gauges that differ may leave open which of them is at fault.
std::optional<Alternative> fit_best_variant(const FitContext& context, const std::vector<ScreenedCandidate>& screened, const ScreenedCandidate& leading) {
  const auto& groups = context.in.groups;
  FitLibrary& library = context.library;
  const std::string& name = groups[leading.group].name;
  const double best_so_far = library.best_log_bayes_factor();
  const auto variant = [](const Alternative& a) { return a.sensor.empty() ? a.places.begin()->second : a.sensor; };
  std::vector<Alternative> all;
  std::map<std::string, ExplanationFit> fits;  // by gauge or law
  for (const auto& other : screened) {
    const bool near = groups[other.group].name == name && other.first_order.log_bayes_factor > leading.first_order.log_bayes_factor - far_behind;
    if (&other != &leading && (!near || all.size() > further_variants)) continue;
    auto fitted = fit_explanation(context, groups[other.group], other, nullptr, best_so_far);
    if (!fitted) continue;  // no runs left
    all.push_back(std::move(*fitted));
    if (auto made = library.fits.extract(name)) fits.emplace(variant(all.back()), std::move(made.mapped()));
  }
  if (all.empty()) return {};
  const auto evidence = [](const Alternative& a) { return a.explanation.log_bayes_factor; };
  // A variant that no runs were left for counts by its first-order evidence where that leads the fitted ones, so that none of these is named as if it were the
  // best.
  double best_fitted = -std::numeric_limits<double>::infinity();
  for (const auto& a : all)
    if (a.explanation.fitted) best_fitted = std::max(best_fitted, evidence(a));
  const auto rank = [&](const Alternative& a) {
    return std::pair(a.explanation.fitted || (context.budget.exhausted() && evidence(a) > best_fitted + Gates{}.lead), evidence(a));
  };
  const auto best = std::max_element(all.begin(), all.end(), [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
  for (const auto& other : all)
    if (&other != &*best && other.explanation.fitted && !other.sensor.empty() && evidence(*best) - evidence(other) < Gates{}.lead)
      best->other_sensors.push_back(other.sensor);
  if (auto made = fits.extract(variant(*best))) library.fits.emplace(name, std::move(made.mapped()));
  return std::move(*best);
}

}  // namespace

void fit_without_runs(const FitContext& context, const std::vector<ScreenedCandidate>& screened) {
  FitLibrary& library = context.library;
  const auto& groups = context.in.groups;
  const auto fit = [&](const ScreenedCandidate& candidate) {
    auto fitted = fit_linearised(context, groups[candidate.group], candidate, nullptr, library.best_log_bayes_factor(), 0);
    if (fitted) library.candidates.push_back(std::move(*fitted));
  };
  const auto gauge = std::find_if(screened.begin(), screened.end(), [](const auto& c) { return c.sensor.has_value(); });
  if (gauge != screened.end()) fit(*gauge);
  for (const auto& candidate : screened)
    if (groups[candidate.group].linear) fit(candidate);
}

void follow_many_small_numbers(const FitContext& context, const std::vector<ScreenedCandidate>& screened) {
  FitLibrary& library = context.library;
  for (const auto& candidate : screened) {
    const ParameterGroup& group = context.in.groups[candidate.group];
    if (!group.linear) continue;
    const auto about_none = find_candidate(library, group.name);
    if (about_none == library.candidates.end()) continue;
    if (!may_lead(about_none->explanation.log_bayes_factor, library.best_log_bayes_factor())) continue;
    library.candidates.erase(about_none);
    auto fitted = fit_linearised(context, group, candidate, nullptr, library.best_log_bayes_factor());
    if (fitted) library.candidates.push_back(std::move(*fitted));
  }
}

std::optional<Alternative> fit_gauge_fault(const FitContext& context, const ParameterGroup& group, const ScreenedCandidate& screened,
                                           const Alternative* on_top_of, double best) {
  const OwnGroup own = with_own_group(context, group, screened);
  std::optional<Alternative> linear;
  if (!context.in.base.box.shrinks()) linear = fit_linearised(context, own.group, own.screened, on_top_of, best);
  if (linear && explains_all(context, *linear)) return linear;
  if (linear) best = std::max(best, linear->explanation.log_bayes_factor);
  auto fitted = fit_explanation(context, own.group, own.screened, on_top_of, best);
  if (!linear || !fitted) return linear ? std::move(linear) : std::move(fitted);
  const Explanation &of_fit = fitted->explanation, &of_linear = linear->explanation;
  const bool better = linear->runs == 0 || !std::isfinite(of_linear.farthest) || of_fit.log_bayes_factor > of_linear.log_bayes_factor;
  return of_fit.fitted && better ? std::move(fitted) : std::move(linear);
}

void fit_leaders(const FitContext& context, const std::vector<ScreenedCandidate>& screened) {
  const DiagnosisInputs& in = context.in;
  FitLibrary& library = context.library;
  int fitted = 0;
  bool best_tried = false, gauge_tried = false;
  for (const auto& candidate : screened) {
    const ParameterGroup& group = in.groups[candidate.group];
    const bool could_lead = may_lead(candidate.first_order.log_bayes_factor, library.best_log_bayes_factor());
    if (candidate.sensor) {
      const bool first = !std::exchange(gauge_tried, true);
      if (!first || fitted >= in.options.leaders || !could_lead) continue;
      fit_leading_gauge(context, group, candidate);
      ++fitted;
      continue;
    }
    if (find_candidate(library, group.name) != library.candidates.end()) continue;  // of a wall with less evidence, too
    if ((!best_tried && context.base.inadequate()) || (fitted < in.options.leaders && (in.base.box.shrinks() || could_lead))) {
      best_tried = true;
      auto explanation = group.sensor.empty() && !group.law ? fit_explanation(context, group, candidate, nullptr, library.best_log_bayes_factor())
                                                            : fit_best_variant(context, screened, candidate);
      if (explanation) {
        library.candidates.push_back(std::move(*explanation));
        ++fitted;
        continue;
      }
    }
    library.candidates.push_back(first_order_explanation(in, context.base, group, candidate));  // where no runs were left for it, too
  }
}

}  // namespace calomel
