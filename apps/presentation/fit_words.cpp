#include "apps/presentation/fit_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/presentation/calibration_lines.hpp"
#include "apps/presentation/posterior_lines.hpp"

namespace calomel {

namespace {

/// "a, b and c".
std::string joined(const std::vector<std::string>& names) {
  std::string s;
  for (std::size_t i = 0; i < names.size(); ++i) s += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return s;
}

/// "2.1 %" or "a factor of 1.5", a standard deviation of a logarithm.
std::string log_sd_text(double sd) { return sd < 0.3 ? fmt::format("{:.2g} %", 100 * sd) : fmt::format("a factor of {:.2g}", std::exp(sd)); }

/// ", to first order KEY VALUE ± SD, ...", the numbers of a score test; empty where they are not distinguished.
std::string score_numbers(const ScoreTest& m) {
  std::string s;
  for (const auto& k : m.keys) s += fmt::format("{}{} {:.3g} ± {:.2g}", s.empty() ? "" : ", ", k.name, k.value, k.sd);
  return s.empty() ? "" : ", to first order " + s;
}

std::string odds(double log_odds) { return fmt::format("odds of at least {:.2g} to 1", std::exp(std::min(log_odds, 700.0))); }

}  // namespace

std::string goodness_sentence(const GoodnessOfFit& g) {
  const std::string numbers = fmt::format("chi-squared {:.4g} for {} values less {} parameters (p {:.2g}), {:.3g} for {:.3g} effective data (p {:.2g})", g.chi2,
                                          g.values, g.parameters, g.p_value, g.effective_chi2, g.effective_data, g.effective_p_value);
  if (!g.adequate) return "the fit is not adequate: the model omits more than noise and known errors explain: " + numbers;
  const std::string fits = "the records do not contradict the fit: " + numbers;
  if (!g.errors_too_wide) return fits;
  return fits + fmt::format(
                    "; the errors taken for granted are {:.2g} times as wide as the residuals, and chi-squared would have spoken only above {:.4g}: it has not "
                    "seen what adds less than {:.3g} to it",
                    std::sqrt((double(g.values) - double(g.parameters)) / g.chi2), g.chi2_critical, g.chi2_critical - g.chi2);
}

std::string settling_text(const Settling& s) {
  if (s.settled) return fmt::format("settled after {} coarse and {} fine runs", s.coarse, s.fine);
  return fmt::format(
      "not settled after {} coarse and {} fine runs: the mode moved by {:.2g} standard deviations in the last round, the emulator's variance is {:.2g} of one "
      "run's noise",
      s.coarse, s.fine, s.moved, s.variance);
}

std::string identification_sentence(const Identification& identification) {
  if (identification.directions.empty()) return "no parameter is positive, so that products of powers have no meaning here";
  std::string pinned;
  std::string open;
  for (const auto& d : identification.directions) {
    std::string& list = d.pinned ? pinned : open;
    list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", d.product, std::isfinite(d.data_sd) ? "sd " + log_sd_text(d.data_sd) : "they say nothing of it");
  }
  if (pinned.empty()) return "the data pin no combination much better than was known before; least of all " + identification.directions.back().product;
  return "the data pin " + pinned + (open.empty() ? " and leave no combination free" : " and leave free " + open);
}

std::string score_test_sentence(const ScoreTests& tests) {
  const ScoreTest* first = tests.first();
  if (!first) return "";
  if (!tests.stands_out) {
    std::string names;
    for (const auto& m : tests.mechanisms)
      if (m.counts) names += (names.empty() ? "" : ", ") + m.name;
    return fmt::format(
        "whatever the covariance's scale, the residual does not point where one of these would show: {} (least p {:.2g}); what else may be missing was not "
        "looked for",
        names, tests.p_value);
  }
  const std::string of_runs = tests.with_runs ? fmt::format(", {:.2g} at runs where nothing is missing", first->f_of_runs) : "";
  const std::string outcome =
      fmt::format("F {:.3g} for {} directions{}, p {:.2g} of {} sets", first->f, first->directions, of_runs, tests.p_value, tests.counted());
  if (first->name == gauge_gains_name)
    return fmt::format(
        "whatever the covariance's scale, amplitudes of single gauges do not fit together ({}): the load, gauges, or the answer itself may be off by more than "
        "its standard deviations",
        outcome);
  return fmt::format("whatever the covariance's scale, the residual points where {} would show ({}{}): enable it, fit anew and compare (map.compare_with)",
                     first->name, outcome, score_numbers(*first));
}

std::string check_sentence(const TrueModelCheck& check) {
  if (check.runs.empty()) return "no run of the true model was requested (emulator.check_coarse, check_fine): the emulator was not checked";
  if (check.done == 0) return "no run of the true model succeeded at the posterior's draws: the emulator was not checked";
  return fmt::format(
             "{} runs of the true model at the mode and at draws lie {:.2g} times as far from the emulator as it promises (mean square {:.2g}, expected 1 ± "
             "{:.2g}, p {:.2g})",
             check.done, std::sqrt(check.score), check.score, check.score_sd, check.p_value) +
         (check.holds ? "" : ": its deviations are too small there; give it more runs (emulator.rounds, emulator.round_fine)");
}

std::string nested_sentence(const NestedModel& n) {
  const std::string added = joined(n.added);
  const std::string numbers = fmt::format(
      "log Bayes factor {:.3g}, between {:.3g} and {:.3g} with priors twice and half as wide; chi-squared {:.4g} with and {:.4g} without for {} values",
      n.log_bayes_factor, n.low, n.high, n.chi2, n.nested_chi2, n.values);
  switch (n.verdict) {
    case NestedVerdict::added_favoured:
      return fmt::format("the records favour {} over {} by {} ({})", added, n.name, odds(n.low), numbers);
    case NestedVerdict::added_not_favoured:
      return fmt::format("the records speak against {}: {} is favoured by {} ({})", added, n.name, odds(-n.high), numbers);
    case NestedVerdict::undecided:
      return fmt::format("the records do not decide between {} and a model with {} as well ({})", n.name, added, numbers);
  }
  return "";
}

std::string refinement_end(RefinementEnd end) {
  switch (end) {
    case RefinementEnd::holds:
      return "the true model agrees with the emulator";
    case RefinementEnd::unchecked:
      return "no run of the true model succeeded, so it was not checked";
    case RefinementEnd::none_allowed:
      return "none was requested (posterior.refinements)";
    case RefinementEnd::limit:
      return "there are no more to be made (posterior.refinements)";
  }
  return "";
}

std::string map_message(const MapSummary& summary, const PosteriorFit& fit) {
  if (summary.status == CalibrationStatus::no_candidate) return "the true model failed at the mode, which is the emulator's alone: " + summary.best.message;
  return fmt::format("log posterior {:.6g} on the emulator, which {}; {}", summary.log_likelihood + summary.log_prior, settling_text(fit.settling()),
                     goodness_sentence(summary.fit));
}

std::vector<std::string> map_warnings(const MapSummary& summary, const PosteriorInputs& in, const PosteriorFit& fit) {
  std::vector<std::string> out;
  if (summary.status == CalibrationStatus::no_candidate) out.push_back(map_message(summary, fit));
  if (!fit.settled) out.push_back(emulator_sentence(fit));
  if (!summary.check.holds) out.push_back(check_sentence(summary.check));
  if (!summary.fit.adequate) out.push_back(goodness_sentence(summary.fit));
  for (const auto& x : summary.nuisances)
    if (std::abs(x.deviation) > 1)
      out.push_back(
          fmt::format("the records shift {} to {:.3g}, {:.2g} standard deviations from its prior mean: it may compensate for an effect that the model omits",
                      x.name == "beyond" ? "the multiple of the last mesh difference beyond the finest mesh" : x.name, x.value, std::abs(x.deviation)));
  for (std::size_t k = 0; k < in.problem.shape.parameters.size(); ++k) {
    const Parameter& p = in.problem.shape.parameters[k];
    const double sd = std::sqrt(summary.covariance(Eigen::Index(k), Eigen::Index(k)));
    const double room = std::min(summary.theta[k] - p.min, p.max - summary.theta[k]);
    if (room < 1e-3 * (p.max - p.min))
      out.push_back(fmt::format("{} = {:.6g} lies on a bound: its best value is beyond the bound, or the data do not determine it", p.name, summary.theta[k]));
    else if (room < 2 * sd)
      out.push_back(
          fmt::format("a bound of {} lies within two standard deviations: its interval and the evidence are those of a density that reaches beyond", p.name));
  }
  if (const double drift = fit.errors->noise().split_half; drift > 2)
    out.push_back(fmt::format("early and late pulses differ {:.2g} times more than independent pulses would: the records drift", drift));
  return out;
}

MapWords map_words(const MapSummary& summary, const PosteriorFit& fit) {
  return {.calibration = {.meaning = meaning_sentence(summary.product), .mesh = ""},
          .adequacy = goodness_sentence(summary.fit),
          .check = check_sentence(summary.check),
          .nested = summary.nested ? nested_sentence(*summary.nested) : "",
          .identified = identification_sentence(summary.identification),
          .score_tests = summary.score_tests ? score_test_sentence(*summary.score_tests) : "",
          .emulator = settling_text(fit.settling())};
}

}  // namespace calomel
