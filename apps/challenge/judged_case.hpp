#pragma once
/// One case of a suite: what was concealed, and what the diagnosis found.
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "inverse/data/recordings.hpp"
#include "uq/diagnosis/verdict.hpp"

namespace calomel::challenge {

enum class Family { none, single, pair, outside, sensor };
std::string text(Family family);

/// What the generator says of a case (docs/proof/generator.md).
struct Truth {
  Family family = Family::none;
  std::vector<std::string> mechanisms;       ///< the library's names, in alphabetical order; empty for none and outside
  std::vector<std::string> effects;          ///< the generator's
  std::string gauge;                         ///< the one with a fault; empty: none
  double strength = 0;                       ///< relative L2 between the mean records with and without the effects, decimated
  std::map<std::string, double> parameters;  ///< of the base model, by their names
  std::map<std::string, double> numbers;     ///< of the library's equivalents, "MECHANISM.KEY"
};
/// Errors: InputError with file and line for what is absent or of another kind.
Truth read_truth(const std::filesystem::path& path);

struct Interval {
  double mean = 0, sd = 0;
};

/// One line of a ranking.
struct Ranking {
  std::string name;
  double probability = 0;
  std::map<std::string, Interval> numbers;  ///< "MECHANISM.KEY", of a gauge "GAUGE.MECHANISM.KEY"
  std::string gauge;                        ///< whose fault it is; empty: no gauge's
};

/// What is scored of diagnosis.json.
struct Finding {
  VerdictKind verdict = VerdictKind::unknown;
  std::vector<std::string> mechanisms;  ///< named, or not distinguished
  std::vector<Ranking> ranking;
  double heldout_before = 0, heldout_after = 0;   ///< nrmse; not a number where there is none
  std::map<std::string, Interval> before, after;  ///< base parameters
  int runs = 0;
  double wall = 0;      ///< [s]; not a number where it is not known
  bool settled = true;  ///< the fit that the verdict hangs on
};
/// Errors: InputError when the file is no diagnosis, naming what it lacks.
Finding read_finding(const std::filesystem::path& path);

/// Noise floor of a case's records [-]: standard error of the mean record over the pulses, by the Hann window of 50 us that gives the strengths, over the
/// size of the mean record (both root mean square over the record); mean over the gauges, or that of `gauge` where it is not empty. Errors: InputError when
/// there are fewer than two pulses or no such gauge.
double noise_floor(const Recordings& recordings, const std::string& gauge);

struct JudgedCase {
  std::string name;
  Truth truth;
  Finding finding;
  double noise_floor = 0;
};

/// Reads all that is there of the cases of `directory`: those with a diagnosis. `waiting` gets the names of the others.
/// Errors: InputError when a case with a diagnosis has no truth, no case has a diagnosis, or a file cannot be read.
std::vector<JudgedCase> read_judged(const std::filesystem::path& directory, std::vector<std::string>& waiting);

/// A case with all that is scored of it, as score.json lists it.
[[nodiscard]] Json judged_json(const JudgedCase& judged);
/// The cases that a score.json lists, of suites that may no longer be there; `rule_hash` gets the hash of the rule by which they were judged.
/// Errors: InputError when the file is no score or names no rule.
std::vector<JudgedCase> read_scored(const std::filesystem::path& path, std::string& rule_hash);

}  // namespace calomel::challenge
