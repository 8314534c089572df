#pragma once
/// What the stages of one call read, each part made when it is first asked for, and once.
#include <memory>
#include <optional>

#include "apps/command_line.hpp"
#include "apps/inputs/study_case.hpp"
#include "apps/notes.hpp"
#include "base/directory_lock.hpp"
#include "forward/built_in_model.hpp"
#include "forward/external/external_model.hpp"
#include "forward/level_runs.hpp"
#include "forward/line/line_runs.hpp"
#include "forward/runs/run_store.hpp"
#include "inverse/data/problem.hpp"

namespace calomel {

class StudyInputs {
 public:
  /// Reads the case and, but for check and report, makes --out: a place that cannot be written, or that another call works in, is told before the work.
  /// `command` outlives the object. Errors: InputError for anything wrong with the case or the output directory.
  explicit StudyInputs(const CommandLine& command);
  StudyInputs(const StudyInputs&) = delete;
  StudyInputs& operator=(const StudyInputs&) = delete;

  [[nodiscard]] const CommandLine& command() const { return command_; }
  [[nodiscard]] const StudyCase& study() const { return study_; }
  /// Where progress and notes go: stderr, unless --quiet.
  [[nodiscard]] const Notes& notes() const { return notes_; }
  /// An artefact's path in --out.
  [[nodiscard]] std::filesystem::path artefact(const std::string& name) const { return command_.out / name; }
  /// Pulses of an ensemble mean.
  [[nodiscard]] EnsembleOptions ensemble() const { return {.pulses = study_.campaign.pulses, .energy_sd = study_.campaign.pulse_energy_sd}; }

  /// The case's model on a mesh. Errors: InputError with its place (geometry, sensors).
  [[nodiscard]] const BuiltInModel& model();
  /// The case's line, where study().line is there.
  [[nodiscard]] const LineModel& line();
  /// The case's model outside, where study().external is there; its server is asked what it has. Errors: see ExternalModel.
  [[nodiscard]] const ExternalModel& external();
  /// That of the case, whichever it is.
  [[nodiscard]] const ForwardModel& any_model();
  /// Runs of a line or of a model outside, kept in runs().
  [[nodiscard]] NumberedRuns& numbered_runs();
  /// The recordings against the model. What they warn of is told once.
  /// Errors: InputError with its place, see StudyCase::matched_recordings and make_problem.
  [[nodiscard]] const Problem& problem();
  /// Those of the model's sensors. Errors: as problem().
  [[nodiscard]] const Recordings& recordings();
  /// Where a journal of runs stands. With --fresh one of other settings is set aside first.
  [[nodiscard]] std::filesystem::path journal(const std::string& name, const Provenance& provenance) const;
  /// The journal of all runs of the true model. With --fresh one of other settings is set aside first. Errors: see RunStore.
  [[nodiscard]] RunStore& runs();
  /// The emulator's meshes, their runs kept in runs(). Errors: InputError naming emulator.element_sizes.
  [[nodiscard]] LevelRuns& levels();

 private:
  const CommandLine& command_;
  StudyCase study_;
  std::optional<DirectoryLock> lock_;  ///< of --out, by a verb that writes there
  Notes notes_;
  std::unique_ptr<BuiltInModel> model_;
  std::unique_ptr<LineModel> line_;
  std::unique_ptr<ExternalModel> external_;
  std::optional<Recordings> recordings_;
  std::optional<Problem> problem_;
  std::unique_ptr<RunStore> runs_;
  std::unique_ptr<LevelRuns> levels_;
  std::unique_ptr<NumberedRuns> numbered_runs_;
};

}  // namespace calomel
