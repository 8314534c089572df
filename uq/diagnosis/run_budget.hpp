#pragma once
/// The runs of a diagnosis: their number, their limit, and the steps that the limit left out.
#include <span>
#include <string>
#include <vector>

#include "base/errors.hpp"
#include "uq/diagnosis/screening.hpp"

namespace calomel {

/// A step that a diagnosis did not make, or not to its end.
struct SkippedStep {
  enum class Kind {
    mechanisms,        ///< nothing was screened, because channels appear to be mixed up
    screening_failed,  ///< `name`: a run of its screening failed with `message`
    no_effect,         ///< `name`: no number of it changes the records by itself
    relinearisation,   ///< `name`: its numbers were not linearised again, which takes `runs` runs
    fit,               ///< `name`: its fit was not begun, which takes `runs` runs
    search_cut_short,  ///< `name`: the limit ended a search for its fit; the best that was found is reported
    fit_ended,         ///< `name`: the limit ended its fit; `message` of the error that followed, if it was another one
    missing_terms,     ///< the terms that describe the missing effect, which take `runs` runs
  };
  Kind kind = Kind::fit;
  std::string name, message;
  int runs = 0;   ///< that the step takes
  int made = 0;   ///< runs made before it
  int limit = 0;  ///< diagnosis.max_runs, of missing terms diagnosis.term_runs

  bool operator==(const SkippedStep&) const = default;
};

/// Ends a fit at the limit of runs.
class RunLimitReached : public NumericsError {
 public:
  RunLimitReached() : NumericsError("the limit of runs is reached") {}
};

/// Counts the runs of a diagnosis and keeps the steps that its limit left out. Steps check it before they begin; it refuses no run by itself.
class RunBudget {
 public:
  RunBudget(const RunAdded& run, int limit) : run_(run), limit_(limit) {}

  /// Makes runs and counts them; shapes as RunAdded's.
  std::vector<RunRecord> run(const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> added) {
    made_ += int(level.size());
    return run_(thetas, level, added);
  }
  [[nodiscard]] int made() const { return made_; }
  [[nodiscard]] int limit() const { return limit_; }
  [[nodiscard]] bool allows(int more) const { return made_ + more <= limit_; }
  [[nodiscard]] bool used_up() const { return made_ >= limit_; }

  /// Notes that the limit left a fit out, or ended it before it had settled.
  void note_exhausted() { exhausted_ = true; }
  [[nodiscard]] bool exhausted() const { return exhausted_; }

  /// Notes a step that is not made, once.
  void skip(SkippedStep step);
  [[nodiscard]] const std::vector<SkippedStep>& skipped() const { return skipped_; }

 private:
  const RunAdded& run_;
  const int limit_;
  int made_ = 0;
  bool exhausted_ = false;
  std::vector<SkippedStep> skipped_;
};

}  // namespace calomel
