#include "apps/presentation/data_check_words.hpp"

#include <fmt/format.h>

#include <cmath>

#include "apps/presentation/diagnosis_numbers.hpp"

namespace calomel {

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
  if (!checks.dead.empty()) all.push_back(plain_dead(checks.dead));
  for (const auto& m : checks.mislabelled) all.push_back(mislabelled_sentence(m));
  if (checks.clock) all.push_back(clock_sentence(*checks.clock) + " Omitted physics may look the same: run calomel diagnose.");
  for (auto& nuisance : far_deviations(checks.nuisances, options)) all.push_back(std::move(nuisance));
  return all;
}

}  // namespace calomel
