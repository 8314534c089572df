#include "uq/diagnosis/hold_out_predictions.hpp"

#include <algorithm>

namespace calomel {

void keep_held_out_fit(const HeldOut& held_out, HeldOutFit fit, Alternative& a) {
  const HeldOutFit& base = held_out.base();
  for (std::size_t i = 0; i < fit.misfit.size(); ++i) {
    a.held_out.push_back(base.misfit[i]);
    a.held_out.push_back(fit.misfit[i]);
  }
  a.explanation.held_out = held_out.mean(fit.misfit);
  a.held_out_gain = 1 - *a.explanation.held_out / held_out.mean(base.misfit);
  a.held_out_log_bayes_factor = std::move(fit.log_bayes_factor);
  a.held_out_history = std::move(fit.history);
}

void add_hold_out_predictions(const FitContext& context, Alternative& a) {
  const auto& fits = context.library.fits;
  const auto fit = fits.find(a.explanation.name);
  if (!context.held_out.possible() || fit == fits.end() || a.explanation.log_bayes_factor <= 0 || !a.held_out.empty()) return;
  if (a.explanation.of_a_gauge && !context.in.base.box.by_least_squares()) return;
  keep_held_out_fit(context.held_out, context.held_out.by(fit->second.fit), a);
}

HoldOutSummary summarise_hold_out(const FitContext& context, const Verdict& verdict) {
  const HeldOut& held_out = context.held_out;
  const FitLibrary& library = context.library;
  HoldOutSummary out;
  out.history = held_out.base().history;
  out.before = held_out.mean(held_out.base().misfit);
  out.after = out.before;
  std::vector<double> after = held_out.base().misfit, best(after.size(), 0.0);
  for (const auto& c : library.candidates)
    for (std::size_t i = 0; i < c.held_out_log_bayes_factor.size(); ++i)
      if (const double with_penalty = c.held_out_log_bayes_factor[i] + c.selection_penalty; with_penalty > best[i]) {
        best[i] = with_penalty;
        after[i] = c.held_out[2 * i + 1];
      }
  const bool named = !verdict.mechanisms.empty();
  auto fit = library.fits.end();
  if (named) {
    const std::string& name = verdict.mechanisms[0];
    const auto of_name = [&](const auto& c) { return c.explanation.name == name; };
    if (!std::find_if(library.candidates.begin(), library.candidates.end(), of_name)->held_out.empty()) out.after = held_out.mean(after);
    fit = library.fits.find(name);
  }
  out.conditions = held_out.by_condition(fit == library.fits.end() ? nullptr : &fit->second.fit);
  return out;
}

}  // namespace calomel
