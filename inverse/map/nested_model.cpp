#include "inverse/map/nested_model.hpp"

#include <cmath>
#include <numbers>

#include "base/json.hpp"
#include "inverse/posterior/posterior_artefacts.hpp"

namespace calomel {

namespace {

constexpr double decided = 3;  ///< log of odds of 20 to 1, "strong" by Kass and Raftery (1995)

}  // namespace

NestedModel compare_nested(const PosteriorFit& fit, const NestedModel& of) {
  expect(fit.nested && !fit.nested_modes.empty(), "the fit has a nested hypothesis");
  NestedModel out = of;
  const LocalMode& full = fit.modes[0];
  const LocalMode& nested = fit.nested_modes[0];
  const auto at_full = fit.posterior->density(full.at);
  const auto at_nested = fit.nested->density(nested.at);
  out.theta = nested.at.theta;
  out.log_bayes_factor = log_evidence(*fit.posterior, full) - log_evidence(*fit.nested, nested);
  const double prior = double(out.added.size()) * std::numbers::ln2;
  out.low = out.log_bayes_factor - prior;
  out.high = out.log_bayes_factor + prior;
  out.values = fit.posterior->values();
  out.chi2 = at_full.chi2;
  out.nested_chi2 = at_nested.chi2;
  out.variance = at_full.variance;
  out.nested_variance = at_nested.variance;
  out.verdict = out.low > decided ? NestedVerdict::added_favoured : out.high < -decided ? NestedVerdict::added_not_favoured : NestedVerdict::undecided;
  return out;
}

Json nested_json(const NestedModel& n, const std::vector<Parameter>& parameters, const std::string& sentence) {
  const char* verdict = n.verdict == NestedVerdict::added_favoured ? "favoured" : n.verdict == NestedVerdict::added_not_favoured ? "not favoured" : "undecided";
  return {{"with", n.name},
          {"added", n.added},
          {"theta", named(parameters, n.theta)},
          {"log_bayes_factor", number(n.log_bayes_factor)},
          {"low", number(n.low)},
          {"high", number(n.high)},
          {"chi2", number(n.chi2)},
          {"nested_chi2", number(n.nested_chi2)},
          {"emulator_variance", number(n.variance)},
          {"nested_emulator_variance", number(n.nested_variance)},
          {"verdict", verdict},
          {"sentence", sentence}};
}

}  // namespace calomel
