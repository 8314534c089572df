#pragma once
/// What the stages of one call read, each part made when it is first needed, and once.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/command_line.hpp"
#include "apps/inputs/study_case.hpp"
#include "apps/notes.hpp"
#include "base/directory_lock.hpp"
#include "forward/simulation/runs.hpp"
#include "forward/simulation/simulated_model.hpp"
#include "inverse/data/problem.hpp"

namespace calomel {

class StudyInputs {
 public:
  /// Reads the case and, but for check and report, makes --out: a place that cannot be written, or in which another call works, is an error before the work.
  /// `command` outlives the object. Errors: InputError for anything wrong with the case or the output directory.
  /// `warnings_of` makes the warnings about the problem, which are Problem::warnings from then on; empty: as make_problem has them.
  explicit StudyInputs(const CommandLine& command, std::function<std::vector<std::string>(const Problem&)> warnings_of = {});
  StudyInputs(const StudyInputs&) = delete;
  StudyInputs& operator=(const StudyInputs&) = delete;

  [[nodiscard]] const CommandLine& command() const { return command_; }
  [[nodiscard]] const StudyCase& study() const { return study_; }
  /// Where progress and notes go: stderr, unless --quiet.
  [[nodiscard]] const Notes& notes() const { return notes_; }
  /// An artefact's path in --out.
  [[nodiscard]] std::filesystem::path artefact(const std::string& name) const { return command_.out / name; }

  /// The true model of the case.
  [[nodiscard]] const Simulator& simulator() const { return *study_.simulator; }
  /// Its runs, kept in runs.journal. With --fresh a journal of other settings is set aside first. Errors: see RunStore.
  [[nodiscard]] Runs& runs();
  /// Runs of another simulator made from the case, kept in a journal of this name.
  struct OtherRuns {
    std::unique_ptr<RunStore> store;
    std::unique_ptr<Runs> runs;
  };
  [[nodiscard]] OtherRuns runs_of(const Simulator& simulator, const std::string& journal) const;
  /// The recordings against the model. Warnings about them are shown once.
  /// Errors: InputError with its place, see StudyCase::matched_recordings and make_problem.
  [[nodiscard]] const Problem& problem();
  /// The recordings of the model's sensors. Errors: as problem().
  [[nodiscard]] const Recordings& recordings();
  /// What the posterior of the case is set up from: runs, recordings and options, without a surrogate. Errors: as runs() and problem().
  [[nodiscard]] PosteriorCase posterior_case(const Runs::Progress& progress = {});

 private:
  /// Where a journal of runs is. With --fresh one of other settings is set aside first.
  [[nodiscard]] std::filesystem::path journal(const std::string& name, const Provenance& provenance) const;
  const CommandLine& command_;
  StudyCase study_;
  std::optional<DirectoryLock> lock_;  ///< of --out, by a verb that writes there
  Notes notes_;
  std::function<std::vector<std::string>(const Problem&)> warnings_of_;
  ThreadExecutor executor_;
  std::optional<Recordings> recordings_;
  std::optional<Problem> problem_;
  std::unique_ptr<RunStore> store_;
  std::unique_ptr<Runs> runs_;
};

}  // namespace calomel
