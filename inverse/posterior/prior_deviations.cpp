#include "inverse/posterior/prior_deviations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/linear_algebra.hpp"

namespace calomel {

namespace {

constexpr double far = 3;                  ///< with some twenty parameters whose priors are right, one fit in twenty has a larger deviation
constexpr std::size_t most_sentences = 3;  ///< one large error shifts many parameters

struct Words {
  const char *term, *number, *key;
  double ErrorOptions::*sd = nullptr;  ///< null if the deviation has no unit of its own
  double shown = 1;                    ///< shown units in one unit of ErrorOptions
  const char* unit = "";
};
constexpr std::array words{Words{"gain", "the gain", "errors.gain_sd", &ErrorOptions::gain_sd, 100, "%"},
                           Words{"baseline", "the zero", "errors.baseline"},
                           Words{"gauge places", "the place", "errors.gauge_place_sd", &ErrorOptions::gauge_place_sd, 1e3, "mm"},
                           Words{"energy scale", "the energy of all pulses", "errors.energy_scale_sd", &ErrorOptions::energy_scale_sd, 100, "%"},
                           Words{"pulse energy", "the energy of the pulses", "recordings.energy_sd"},
                           Words{"trigger", "the clock of all records", "errors.trigger_sd", &ErrorOptions::trigger_sd, 1e6, "µs"}};

const Words* words_of(const std::string& term) {
  const auto at = std::find_if(words.begin(), words.end(), [&](const Words& w) { return term == w.term; });
  return at == words.end() ? nullptr : &*at;
}

}  // namespace

std::vector<PriorDeviation> prior_deviations(const FitResidual& left) {
  const Cholesky covariance(left.covariance);
  const Eigen::VectorXd residual = covariance.solve_lower(left.residual);
  std::vector<PriorDeviation> all;
  for (const auto& d : left.directions) {
    const Eigen::VectorXd change = covariance.solve_lower(d.change);
    all.push_back({.term = d.term, .gauge = d.gauge, .deviation = change.dot(residual), .sd = std::sqrt(std::max(0.0, 1 - change.squaredNorm()))});
  }
  std::stable_sort(all.begin(), all.end(), [](const PriorDeviation& a, const PriorDeviation& b) { return std::abs(a.deviation) > std::abs(b.deviation); });
  return all;
}

std::string nuisance_name(const std::string& term, const std::string& gauge) {
  const Words* w = words_of(term);
  return (w ? w->number : term) + (gauge.empty() ? "" : " of " + gauge);
}

std::vector<std::string> far_deviations(const std::vector<PriorDeviation>& deviations, const ErrorOptions& errors) {
  std::vector<std::string> sentences;
  std::size_t more = 0;
  for (const auto& p : deviations) {
    if (std::abs(p.deviation) <= far) continue;
    if (sentences.size() == most_sentences) {
      ++more;
      continue;
    }
    const Words* w = words_of(p.term);
    const std::string key = w ? fmt::format(" ({})", w->key) : "",
                      value = w && w->sd ? fmt::format(", {:+.2g} {}", p.deviation * errors.*(w->sd) * w->shown, w->unit) : "";
    sentences.push_back(fmt::format(
        "the records shift {} by {:+.1f} of its prior standard deviations{}{}: its prior is wrong, or it compensates for an effect that the model omits",
        nuisance_name(p.term, p.gauge), p.deviation, key, value));
  }
  if (more > 0) sentences.back() += fmt::format("; {} further nuisance parameters also deviate by more than three (mode.pulls)", more);
  return sentences;
}

}  // namespace calomel
