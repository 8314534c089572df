#include "inverse/map/nested_model.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/json.hpp"
#include "inverse/posterior/posterior_artefacts.hpp"

namespace calomel {

namespace {

constexpr double decided = 3;  ///< log of odds of 20 to 1: "strong" by Kass and Raftery (1995)

std::string joined(const std::vector<std::string>& names) {
  std::string s;
  for (std::size_t i = 0; i < names.size(); ++i) s += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return s;
}

std::string odds(double log_odds) { return fmt::format("odds of at least {:.2g} to 1", std::exp(std::min(log_odds, 700.0))); }

}  // namespace

NestedModel compare_nested(const PosteriorFit& fit, const NestedModel& of) {
  expect(fit.nested && !fit.nested_modes.empty(), "the fit has a nested hypothesis");
  NestedModel out = of;
  const LocalMode &full = fit.modes[0], &nested = fit.nested_modes[0];
  const auto at_full = fit.posterior->density(full.at), at_nested = fit.nested->density(nested.at);
  out.theta = nested.at.theta;
  out.log_bayes_factor = log_evidence(*fit.posterior, full) - log_evidence(*fit.nested, nested);
  const double prior = double(out.added.size()) * std::numbers::ln2;
  out.low = out.log_bayes_factor - prior, out.high = out.log_bayes_factor + prior;
  out.chi2 = at_full.chi2, out.nested_chi2 = at_nested.chi2, out.variance = at_full.variance, out.nested_variance = at_nested.variance;
  out.verdict = out.low > decided ? NestedVerdict::added_favoured : out.high < -decided ? NestedVerdict::added_not_favoured : NestedVerdict::undecided;
  const std::string
      added = joined(out.added),
      numbers = fmt::format(
          "log Bayes factor {:.3g}, between {:.3g} and {:.3g} with priors twice and half as wide; chi-squared {:.4g} with and {:.4g} without for {} values",
          out.log_bayes_factor, out.low, out.high, out.chi2, out.nested_chi2, fit.posterior->values());
  switch (out.verdict) {
    case NestedVerdict::added_favoured:
      out.sentence = fmt::format("the records favour {} over {} by {} ({})", added, out.name, odds(out.low), numbers);
      break;
    case NestedVerdict::added_not_favoured:
      out.sentence = fmt::format("the records speak against {}: {} is favoured by {} ({})", added, out.name, odds(-out.high), numbers);
      break;
    case NestedVerdict::undecided:
      out.sentence = fmt::format("the records do not decide between {} and a model with {} as well ({})", out.name, added, numbers);
      break;
  }
  return out;
}

Json nested_json(const NestedModel& n, const std::vector<Parameter>& parameters) {
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
          {"sentence", n.sentence}};
}

}  // namespace calomel
