#pragma once
/// The stages of a study on one case: each reuses what is finished and matches, and makes first, saying so, what it needs
/// and does not find.
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "apps/command_line.hpp"
#include "apps/pipeline/study_case.hpp"
#include "forward/built_in_model.hpp"
#include "forward/campaign/repeatability_floor.hpp"
#include "forward/emulator/mesh_correction.hpp"
#include "forward/runs/run_store.hpp"
#include "forward/surrogate/surrogate.hpp"
#include "inverse/calibration/calibration.hpp"
#include "inverse/enc/enc.hpp"
#include "inverse/map/map.hpp"
#include "inverse/posterior/basin.hpp"
#include "inverse/data/problem.hpp"
#include "inverse/spe/spe.hpp"

namespace calomel {

struct Provenance;  // base/provenance.hpp

class Stages {
 public:
  /// `command` outlives the object. Errors: InputError for anything wrong with the case or the output directory.
  explicit Stages(const CommandLine& command);

  [[nodiscard]] const CommandLine& command() const { return command_; }
  [[nodiscard]] const StudyCase& study() const { return study_; }
  /// The case's model, made at the first call. Errors: InputError with its place (geometry, sensors).
  [[nodiscard]] const BuiltInModel& model();
  /// The recordings against the model, read at the first call; warnings go to stderr.
  [[nodiscard]] const Problem& problem();

  /// The stages. Each returns done or not_to_be_trusted, writes its artefacts to --out (check writes none) and says in a line
  /// what came of it. check, simulate and report stand in the files of their verbs.
  ExitStatus check();
  ExitStatus simulate();
  ExitStatus campaign();
  ExitStatus train();
  /// Each method once, "all" standing for every one; where two or more then stand, comparison.json, whose tables are said.
  ExitStatus calibrate(const std::vector<std::string>& methods);
  /// The posterior of the parameters on the multilevel emulator, by Markov chains; writes posterior.nc and posterior.json.
  ExitStatus sample();
  ExitStatus report();

  /// The load's policy, the deposited energy and the viscosity, in words, a line each: every run tells them.
  [[nodiscard]] std::vector<std::string> physics();

  /// One line to stderr, unless --quiet.
  void say(const std::string& text) const;

 private:
  ExitStatus calibrate(const std::string& method);
  /// What is done of a stage, told on the display; stops the work when the user asked to.
  [[nodiscard]] CalibrationProgress stage_progress(const std::string& stage) const;
  /// Where the emulator's first box stands, (n_parameters of the case); trains the surrogate first where that tells it. `fine`: a run of the finest mesh.
  std::vector<double> basin(const CalibrationProgress& progress, const FineRun& fine);
  /// The emulator and its posterior, the runs taken from and kept in runs.journal.
  std::unique_ptr<struct CasePosterior> fit_case_posterior(const CalibrationProgress& progress, const struct NestedFit* nested = nullptr);
  /// It, fitted once for all that is done in this call.
  const CasePosterior& case_posterior(const CalibrationProgress& progress);
  /// Whether the emulator has a mesh that the case's own can be corrected by; otherwise `why`, if it is given, is told the reason.
  [[nodiscard]] bool corrects_mesh(std::string* why = nullptr) const;
  /// For `method`: finest mesh of the emulator less the case's own, taught by the posterior's runs, once for all methods of this call. Null when it is not
  /// `wanted` or, saying so in a line, when the emulator has no other mesh. Errors: InputError naming emulator.element_sizes when the case's own is none of them.
  const MeshCorrection* mesh_correction(const std::string& method, bool wanted, const CalibrationProgress& progress);
  [[nodiscard]] Provenance runs_provenance() const;
  /// The journal of all runs of the true model beside the campaign, opened at the first call. With --fresh one of other settings is set aside first.
  RunStore& run_store();
  [[nodiscard]] Provenance posterior_provenance() const;
  /// Writes comparison.json from the calibrations of these recordings that stand in --out, when there are two or more.
  void compare();
  /// The ensemble mean at the case's own numbers; what simulate.json tells of it goes to `json`. Both give (condition, sensor, time).
  std::vector<double> simulate_mean(Json& json);
  /// simulate takes the numbers of the tables: a nominal value that says otherwise is told. Errors: InputError when it was asked for by --set, since it
  /// would have no effect.
  void tell_nominals_left_out() const;
  /// One run, gone on with where an earlier one was cut off.
  std::vector<double> simulate_once(const Provenance& provenance, Json& json);
  /// Measures the floor, run by run kept in floor.journal, and writes floor.json.
  void measure_floor();
  /// What `check` tells people, a line each: what will be run and what it costs.
  [[nodiscard]] std::vector<std::string> plan();
  /// The same of the recordings, the cost and the stages.
  [[nodiscard]] std::vector<std::string> cost(const ModelDescription& d);
  void say_floor(const RepeatabilityFloor& floor) const;
  [[nodiscard]] Provenance floor_provenance() const;
  /// Makes floor.json first, saying so, where there is none of this model.
  void need_floor();
  /// Recordings of the model's sensors, without the warnings, which were said before.
  [[nodiscard]] Recordings recordings();
  SpeSummary calibrate_spe(const Provenance& provenance, const CalibrationProgress& progress);
  EncSummary calibrate_enc(const Provenance& provenance, const Surrogate& surrogate, const Archive& archive, const CalibrationProgress& progress);
  /// The mode of the posterior on the emulator; writes its artefacts.
  MapSummary calibrate_map(const Provenance& provenance, const CalibrationProgress& progress);
  /// map.compare_with from where the case stands.
  [[nodiscard]] std::filesystem::path nested_directory() const;
  /// Says why runs of the campaign failed, if any did, and how well the boundary is known.
  void say_failures(const Archive& archive, const class Feasibility& feasibility) const;
  enum class Asked { by_user, upstream };
  [[nodiscard]] Provenance campaign_provenance() const;
  [[nodiscard]] Provenance train_provenance() const;
  [[nodiscard]] Provenance calibration_provenance(const std::string& method) const;
  /// Whether the artefacts must be set aside first (--fresh): those of the stage that the user asked for, and those upstream
  /// that do not match. Errors: InputError naming the changed keys where they do not match and --fresh was not given.
  [[nodiscard]] bool to_be_set_aside(const Provenance& now, Asked asked);
  /// Whether the stage must be done: false when its summary matches `now` and all `files` stand. Sets them aside as above.
  [[nodiscard]] bool due(const Provenance& now, const std::vector<std::string>& files, Asked asked);
  ExitStatus campaign(Asked asked);
  ExitStatus train(Asked asked);
  /// Runs one method and writes its artefacts.
  Calibration calibrated_by(const std::string& method, const Provenance& provenance);

  const CommandLine& command_;
  StudyCase study_;
  std::unique_ptr<BuiltInModel> model_;
  std::optional<Problem> problem_;
  std::unique_ptr<RunStore> runs_;
  std::shared_ptr<CasePosterior> posterior_;  ///< once it was asked for, as the next
  std::optional<MeshCorrection> correction_;
  std::set<std::string> begun_;  ///< stages that this call has come to: --fresh sets nothing of them aside again
};

/// The worse of two ends.
inline ExitStatus worse(ExitStatus a, ExitStatus b) { return a == ExitStatus::done ? b : a; }

}  // namespace calomel
