#include "inverse/posterior/pulls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/linear_algebra.hpp"

namespace calomel {

namespace {

constexpr double far = 3;                  ///< of some twenty numbers that are as they were said to be, one in twenty fits has one beyond
constexpr std::size_t most_sentences = 3;  ///< the farthest: where much is wrong, much is pulled

struct Words {
  const char *term, *number, *key;
  double ErrorOptions::*sd = nullptr;  ///< where it has a unit of its own
  double shown = 1;                    ///< units in one of ErrorOptions'
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

std::vector<Pull> pulls(const FitResidual& left) {
  const Cholesky covariance(left.covariance);
  const Eigen::VectorXd residual = covariance.solve_lower(left.residual);
  std::vector<Pull> all;
  for (const auto& d : left.directions) {
    const Eigen::VectorXd change = covariance.solve_lower(d.change);
    all.push_back({.term = d.term, .gauge = d.gauge, .pull = change.dot(residual), .sd = std::sqrt(std::max(0.0, 1 - change.squaredNorm()))});
  }
  std::stable_sort(all.begin(), all.end(), [](const Pull& a, const Pull& b) { return std::abs(a.pull) > std::abs(b.pull); });
  return all;
}

std::string pulled_number(const std::string& term, const std::string& gauge) {
  const Words* w = words_of(term);
  return (w ? w->number : term) + (gauge.empty() ? "" : " of " + gauge);
}

std::vector<std::string> far_pulls(const std::vector<Pull>& pulls, const ErrorOptions& errors) {
  std::vector<std::string> sentences;
  std::size_t more = 0;
  for (const auto& p : pulls) {
    if (std::abs(p.pull) <= far) continue;
    if (sentences.size() == most_sentences) {
      ++more;
      continue;
    }
    const Words* w = words_of(p.term);
    const std::string key = w ? fmt::format(" ({})", w->key) : "",
                      value = w && w->sd ? fmt::format(", {:+.2g} {}", p.pull * errors.*(w->sd) * w->shown, w->unit) : "";
    sentences.push_back(fmt::format(
        "the records pull {} by {:+.1f} of its standard deviations{}{}: it is not what was said of it, or takes up something that the model leaves out",
        pulled_number(p.term, p.gauge), p.pull, key, value));
  }
  if (more > 0) sentences.back() += fmt::format("; so with {} further numbers (mode.pulls)", more);
  return sentences;
}

}  // namespace calomel
