#include "apps/presentation/data_check_words.hpp"

#include <fmt/format.h>

#include <cmath>

#include "apps/presentation/diagnosis_numbers.hpp"

namespace calomel {

std::string mislabelled_sentence(const MislabelledChannel& m) {
  if (m.own > 0 && m.other.empty())
    return fmt::format(
        "Gauge {} reads {:.2g} times what the others let expect there, in the course that is simulated (correlation {:.2f}): see to its unit and its gain.",
        m.gauge, m.factor, m.own);
  if (m.other.empty())
    return fmt::format(
        "Gauge {} reads what is simulated there with the other sign (correlation {:.2f}): see whether it is wired the wrong way round, or its direction wrong.",
        m.gauge, m.own);
  return fmt::format(
      "Gauge {} reads what is simulated at {}, and {} what is simulated at {} (correlation {:.2f}, with its own {:.2f}): see whether the two are taken for "
      "each other.",
      m.gauge, m.other, m.other, m.gauge, m.like, m.own);
}

std::string clock_sentence(const ClockOffset& c) {
  const ShownUnit unit = shown_unit("s", std::abs(c.delay));
  return fmt::format(
      "All records look {} {} (log Bayes factor {:.3g} to first order): see from which instant they count, and set recordings.trigger_offset, or "
      "errors.trigger_sd where that is not known.",
      with_sd(unit.factor * std::abs(c.delay), unit.factor * c.sd, unit.name), c.delay > 0 ? "late" : "early", c.log_bayes_factor);
}

std::vector<std::string> data_check_sentences(const DataChecks& checks, const ErrorOptions& options) {
  std::vector<std::string> all;
  if (!checks.dead.empty()) all.push_back(plain_dead(checks.dead));
  for (const auto& m : checks.mislabelled) all.push_back(mislabelled_sentence(m));
  if (checks.clock) all.push_back(clock_sentence(*checks.clock) + " Physics that was left out may look so, too: ask calomel diagnose.");
  for (auto& nuisance : far_pulls(checks.nuisances, options)) all.push_back(std::move(nuisance));
  return all;
}

}  // namespace calomel
