#include "apps/presentation/data_check_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/presentation/diagnosis_numbers.hpp"

namespace calomel {

namespace {

constexpr std::size_t most_sentences = 3;  ///< one large error shifts many parameters

/// The words for a marginalised nuisance parameter.
struct NuisanceWords {
  const char *term, *number, *key;
  double ErrorOptions::*sd = nullptr;  ///< null if the deviation has no unit of its own
  double shown = 1;                    ///< shown units in one unit of ErrorOptions
  const char* unit = "";
};
constexpr std::array nuisance_words{
    NuisanceWords{"gain", "the gain", "errors.gain_sd", &ErrorOptions::gain_sd, 100, "%"},
    NuisanceWords{"baseline", "the zero", "errors.baseline"},
    NuisanceWords{"gauge places", "the place", "errors.gauge_place_sd", &ErrorOptions::gauge_place_sd, 1e3, "mm"},
    NuisanceWords{"energy scale", "the energy of all pulses", "errors.energy_scale_sd", &ErrorOptions::energy_scale_sd, 100, "%"},
    NuisanceWords{"pulse energy", "the energy of the pulses", "recordings.energy_sd"},
    NuisanceWords{"trigger", "the clock of all records", "errors.trigger_sd", &ErrorOptions::trigger_sd, 1e6, "µs"}};

const NuisanceWords* words_of(const std::string& term) {
  const auto at = std::find_if(nuisance_words.begin(), nuisance_words.end(), [&](const NuisanceWords& w) { return term == w.term; });
  return at == nuisance_words.end() ? nullptr : &*at;
}

}  // namespace

std::string dead_gauges_sentence(std::span<const std::string> labels) {
  const bool one = labels.size() == 1;
  return fmt::format("{} {} nothing but noise and {} left out: see whether {} dead, and name {} in recordings.exclude.",
                     (one ? "Gauge " : "Gauges ") + join(labels), one ? "records" : "record", one ? "is" : "are", one ? "it is" : "they are",
                     one ? "it" : "them");
}

std::vector<std::string> problem_warnings(const Problem& problem) {
  std::vector<std::string> all = problem.warnings;
  if (!problem.dead.empty()) all.push_back(dead_gauges_sentence(problem.dead));
  std::vector<std::string> narrow;
  for (const auto& o : problem.observations)
    if (o.narrow > 0) narrow.push_back(fmt::format("{} {}/{}", problem.label(o), o.narrow, o.samples));
  if (!narrow.empty()) all.push_back("samples whose band is narrower than 1 % of the peak are left out of accuracy and delta2: " + join(narrow));
  if (std::all_of(problem.observations.begin(), problem.observations.end(), [](const auto& o) { return o.banded_samples == 0; }))
    all.push_back("no sample has a band of 1 % of its gauge's peak or more: accuracy is not defined and counts as 0");
  return all;
}

std::string nuisance_name(const std::string& term, const std::string& gauge) {
  const NuisanceWords* w = words_of(term);
  return (w ? w->number : term) + (gauge.empty() ? "" : " of " + gauge);
}

std::vector<std::string> far_deviation_sentences(const std::vector<PriorDeviation>& deviations, const ErrorOptions& errors) {
  std::vector<std::string> sentences;
  std::size_t more = 0;
  for (const auto& p : deviations) {
    if (std::abs(p.deviation) <= far_deviation) continue;
    if (sentences.size() == most_sentences) {
      ++more;
      continue;
    }
    const NuisanceWords* w = words_of(p.term);
    const std::string key = w ? fmt::format(" ({})", w->key) : "";
    const std::string value = w && w->sd ? fmt::format(", {:+.2g} {}", p.deviation * errors.*(w->sd) * w->shown, w->unit) : "";
    sentences.push_back(fmt::format(
        "the records shift {} by {:+.1f} of its prior standard deviations{}{}: its prior is wrong, or it compensates for an effect that the model omits",
        nuisance_name(p.term, p.gauge), p.deviation, key, value));
  }
  if (more > 0) sentences.back() += fmt::format("; {} further nuisance parameters also deviate by more than three (mode.pulls)", more);
  return sentences;
}

std::string mislabelled_sentence(const MislabelledChannel& m) {
  if (m.own > 0 && m.other.empty())
    return fmt::format(
        "The record of gauge {} has the simulated shape (correlation {:.2f}), but {:.2g} times the size that the other gauges let expect. Check its unit and "
        "its "
        "gain.",
        m.gauge, m.own, m.factor);
  if (m.other.empty())
    return fmt::format("The record of gauge {} has the opposite sign of its simulation (correlation {:.2f}). Check its wiring and its direction in the case.",
                       m.gauge, m.own);
  return fmt::format(
      "The record of gauge {} is like the simulation at {}, and that of {} like the simulation at {} (correlation {:.2f}; {:.2f} with its own). Check whether "
      "the "
      "two channels are swapped.",
      m.gauge, m.other, m.other, m.gauge, m.like, m.own);
}

std::string clock_sentence(const ClockOffset& c) {
  const ShownUnit unit = shown_unit("s", std::abs(c.delay));
  return fmt::format(
      "All records look {} {} (log Bayes factor {:.3g} to first order). Check the instant from which they count, and set recordings.trigger_offset; where the "
      "instant is not known, set errors.trigger_sd.",
      with_sd(unit.factor * std::abs(c.delay), unit.factor * c.sd, unit.name), c.delay > 0 ? "late" : "early", c.log_bayes_factor);
}

std::vector<std::string> data_check_sentences(const DataChecks& checks, const ErrorOptions& options) {
  std::vector<std::string> all;
  if (!checks.dead.empty()) all.push_back(dead_gauges_sentence(checks.dead));
  for (const auto& m : checks.mislabelled) all.push_back(mislabelled_sentence(m));
  if (checks.clock) all.push_back(clock_sentence(*checks.clock) + " Omitted physics may look the same: run calomel diagnose.");
  for (auto& nuisance : far_deviation_sentences(checks.nuisances, options)) all.push_back(std::move(nuisance));
  return all;
}

}  // namespace calomel
