#pragma once
/// Runs that a later stage adds to a campaign where it needs them: on the case's own mesh and, paired with them, on a finer one. They stand beside the
/// archive, in added_runs.journal (which resumes after any kill) and, for readers, added_runs.nc; campaign.nc itself is never edited.
#include <Eigen/Core>
#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "forward/campaign/journal.hpp"
#include "forward/model.hpp"

namespace calomel {

struct Provenance;  // base/provenance.hpp

/// A point and what came of it. `fine` is empty where no finer mesh was asked for.
struct AddedRun {
  std::vector<double> theta;
  RunRecord working;
  std::optional<RunRecord> fine;
  /// All that was asked for came through.
  [[nodiscard]] bool done() const { return working.done && (!fine || fine->done); }
  /// It came through on both meshes.
  [[nodiscard]] bool paired() const { return working.done && fine && fine->done; }
};

/// A run of added_runs.nc.
struct KeptRun {
  AddedRun run;
  std::vector<std::string> asked_by;  ///< empty in files that do not tell
};

/// What added_runs.nc at `path` holds; nothing where there is none. `names`: of its parameters, in the order of theta.
/// Errors: InputError when its histories are of another length than `values`.
std::vector<KeptRun> read_added_runs(const std::filesystem::path& path, std::size_t values, std::vector<std::string>& names);

class AddedRuns {
 public:
  using Progress = std::function<void(std::size_t done, std::size_t total)>;

  /// `fine`: the same model on a finer mesh, or null; both outlive the object. Opens or begins the journal in `directory`.
  /// Errors: InputError when it was begun with other settings, is in use, or cannot be written.
  AddedRuns(const ForwardModel& working, const ForwardModel* fine, const Provenance& provenance, const std::filesystem::path& directory);

  /// Runs the columns of `thetas` (n_parameters, n), those on the finer mesh too where `with_fine` says so (n), on `threads` threads, the costly ones
  /// first. What the journal holds of exactly these parameters is taken from it. A failed run is a record with its reason.
  /// Errors: those of the models; Interrupted when `stop` became true, after the runs in progress.
  std::vector<AddedRun> run(const Eigen::MatrixXd& thetas, const std::vector<bool>& with_fine, int threads, const Progress& progress = {},
                            const std::atomic<bool>* stop = nullptr);

  /// All that were asked for in this object's life, in order.
  [[nodiscard]] const std::vector<AddedRun>& all() const { return all_; }
  [[nodiscard]] bool has_fine() const { return fine_ != nullptr; }
  /// Solver runs that were made, not taken from the journal.
  [[nodiscard]] std::size_t made() const { return made_; }
  [[nodiscard]] std::size_t reused() const { return reused_; }
  /// Writes added_runs.nc: theta(run, parameter), strain and strain_fine(run, sensor, time), status and status_fine(run), message(run), and asked_by(run), the
  /// calibrations ("enc", "map", "spe") that asked for it. Runs that other calibrations asked for, as an earlier added_runs.nc of the same model tells, stay; those
  /// that `method` asked for once and not in this object's life go (the journal keeps them).
  void write(const std::filesystem::path& directory, const std::string& method) const;

 private:
  /// Where the journal keeps a run: FNV-1a over the parameters' bytes and the mesh.
  static std::size_t key(std::span<const double> theta, bool fine);
  const ForwardModel& working_;
  const ForwardModel* fine_;
  std::shared_ptr<const Provenance> provenance_;
  Journal journal_;
  std::vector<AddedRun> all_;
  std::size_t made_ = 0, reused_ = 0;
};

}  // namespace calomel
