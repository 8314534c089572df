#pragma once
/// How a diagnosis did on a suite. What every number means: docs/proof/challenge.md
#include <array>
#include <map>
#include <string>
#include <vector>

#include "apps/challenge/judged_case.hpp"
#include "base/options.hpp"

namespace calomel::challenge {

/// Exact one-sided bounds of a share (Clopper and Pearson 1934, Biometrika 26, 404), each at `confidence`; [0, 1] of no trial.
struct Bounds {
  double lower = 0, upper = 1;
};
[[nodiscard]] Bounds clopper_pearson(std::size_t successes, std::size_t trials, double confidence = 0.95);

/// `count` of `of`.
struct Share {
  std::size_t count = 0, of = 0;
  void add(bool yes) { count += yes, ++of; }
  [[nodiscard]] double share() const { return of > 0 ? double(count) / double(of) : 0; }
  [[nodiscard]] Bounds bounds() const { return clopper_pearson(count, of); }
};

/// What a verdict is beside the truth.
enum class Outcome {
  right,    ///< none where nothing is concealed; none or unknown outside the library; else the mechanism, or both of a pair, named
  among,    ///< ambiguous, the truth is one of those that were not distinguished
  part,     ///< named or ambiguous otherwise, with a name that the truth has: one of a pair, a pair with one too many
  wrong,    ///< named or ambiguous with nothing of the truth
  unknown,  ///< the verdict unknown, in the library or with nothing concealed
  missed    ///< the verdict none where something of the library is concealed
};
inline constexpr std::size_t outcome_count = 6;
std::string text(Outcome outcome);
[[nodiscard]] Outcome outcome_of(const Truth& truth, const Finding& finding);

/// Outcomes of a group of cases.
struct Tally {
  std::array<std::size_t, outcome_count> count{};
  [[nodiscard]] std::size_t cases() const;
  [[nodiscard]] std::size_t operator[](Outcome o) const { return count[std::size_t(o)]; }
};

/// A bin of claimed probabilities.
struct ReliabilityBin {
  double low = 0, high = 0, claimed = 0;  ///< claimed: mean of those in it
  Share came_true;
};

struct ParameterErrors {
  double before = 0, after = 0;  ///< root mean square of the relative errors
  std::size_t cases = 0;
};

enum class GateState { met, not_met, no_case };

/// A demand of the proof on a bound of a share, or on a number.
struct GateResult {
  std::string name;
  double value = 0;  ///< the share, or the number
  double bound = 0;  ///< what is held against the threshold
  double threshold = 0;
  bool at_most = true;            ///< else at least
  std::size_t count = 0, of = 0;  ///< of a share; `of` cases of a number
  bool share = true;
  GateState state = GateState::no_case;
};

struct Score {
  std::size_t cases = 0, below_noise = 0, unsettled = 0;
  std::map<std::string, std::map<std::string, std::size_t>> confusion;  ///< truth -> verdict -> cases
  Tally none, singles, pairs, outside, sensors;                         ///< singles, pairs and sensors: those above the noise
  Tally faint;                                                          ///< singles, pairs and sensors below it
  Share right_gauge;                                                    ///< of faults of a gauge that were named: its gauge
  double brier = 0;
  std::map<std::string, std::pair<double, std::size_t>> brier_by_family;  ///< mean and cases
  std::vector<ReliabilityBin> reliability;
  Share base_covered, base_covered_all;              ///< by 95 % intervals; where the verdict is right, and everywhere
  Share numbers_covered;                             ///< the mechanism's, where it is named rightly
  double base_deviation = 0, numbers_deviation = 0;  ///< root mean square of (mean - truth) / sd of the same
  Share heldout_improved;
  double heldout_before = 0, heldout_after = 0;  ///< means over those cases
  Share base_nearer;
  std::map<std::string, ParameterErrors> base_errors;
  double error_before = 0, error_after = 0;  ///< of all base parameters together, in the handbook's standard deviations
  double runs_mean = 0, runs_median = 0, runs_most = 0;
  double wall_mean = 0, wall_median = 0, wall_most = 0;  ///< [s]
  std::size_t walls = 0;                                 ///< cases for which it is known
  std::vector<GateResult> gates;
};

/// An effect is below the noise when its strength is below this many times the noise floor of the records.
inline constexpr double faint_below = 2;

/// At least one case.
[[nodiscard]] Score score_of(const std::vector<JudgedCase>& cases);

/// Contents of score.json, and the same for people.
[[nodiscard]] Json score_json(const Score& score, const std::vector<JudgedCase>& cases);
[[nodiscard]] std::vector<std::string> score_lines(const Score& score);

}  // namespace calomel::challenge
