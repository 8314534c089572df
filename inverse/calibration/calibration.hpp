#pragma once
/// What every point calibration shares, whatever proposed the points: the best distinct proposals and the nominal point are run in
/// the true model, the best by the true model wins, and the artefacts hold the same keys.
#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/options.hpp"
#include "inverse/calibration/correction_report.hpp"
#include "inverse/objective/objective.hpp"
#include "inverse/optimizer/optimizer.hpp"
#include "inverse/data/problem.hpp"

namespace calomel {

struct Provenance;     // base/provenance.hpp
class MeshCorrection;  // forward/emulator/mesh_correction.hpp

/// A point that a search proposes.
struct Proposal {
  double cost = 0;            ///< by the surrogate, smaller is better (Objective::cost)
  std::vector<double> theta;  ///< (n_parameters)
};

/// A point at which the true model was run.
struct Candidate {
  std::vector<double> theta;
  double objective_surrogate = 0;         ///< NaN without a surrogate
  std::optional<double> objective_model;  ///< empty: the true model failed there
  std::string message;                    ///< why it failed
  Score score;
  bool inside_emulator = true;  ///< where predictions are corrected for the mesh: the point lies in the box in which that is known
};

enum class CalibrationStatus { not_run, done, not_settled, no_candidate };

/// The outcome of a point calibration, before what is a method's own. Its message, and the warnings that follow those of the problem, are made by
/// apps/presentation.
struct Calibration {
  CalibrationStatus status = CalibrationStatus::not_run;
  std::string message = "the calibration was not run";
  Objective objective;
  std::string product = "tuned";
  std::vector<double> theta, nominal;              ///< (n_parameters) in declared order
  Candidate best, at_nominal;                      ///< as the true model has them
  std::vector<Candidate> candidates;               ///< best by the true model first; failed ones only when no other was left
  std::vector<Candidate> failed;                   ///< candidates replaced by another because the true model failed
  std::size_t wanted = 0;                          ///< candidates that were to be run
  std::vector<double> calibrated, nominal_values;  ///< (condition, sensor, time) true-model means, corrected where mesh.used; empty where failed
  CorrectionReport mesh;                           ///< where used, scores and objectives of all candidates are those with the correction
  std::vector<std::string> warnings;
  std::size_t evaluations = 0;       ///< of the surrogate
  std::size_t model_runs = 0;        ///< of the true model
  double search_s = 0, model_s = 0;  ///< wall time of the search and of the true-model runs [s]
  [[nodiscard]] bool trusted() const { return status == CalibrationStatus::done; }
  /// Whether candidates were run and none is better in the true model than the nominal point, which is the answer then.
  [[nodiscard]] bool nominal_kept() const;
};

/// What is done and what there is to do, of "true-model runs" or a stage of the search; called from any thread, one at a time.
using CalibrationProgress = std::function<void(const std::string& what, std::size_t done, std::size_t total)>;

/// Seconds since it was made.
class Clock {
 public:
  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// The box of the parameters' bounds.
Bounds bounds_of(const ModelShape& shape);

/// Largest difference over the parameters, in units of their bounds.
double distance(const Proposal& a, const Proposal& b, const Bounds& bounds);
/// Proposals in their order, at most n of them, each at least `separation` from those before it and never equal to one.
std::vector<Proposal> spread_out(const std::vector<Proposal>& pool, std::size_t n, double separation, const Bounds& bounds);
/// The same in order of cost.
std::vector<Proposal> well_separated(std::vector<Proposal> pool, std::size_t n, double separation, const Bounds& bounds);

/// A calibration before the search: the objective, the nominal point, the problem's warnings.
Calibration begin_calibration(const Problem& problem, Objective objective);

/// Runs the first `wanted` of `ranked` and the nominal point in the true model on `threads` threads; where the true model fails, the next
/// in rank takes the place. Fills all of `out` from `status` to `nominal_values`, but for the message; counts runs and time.
/// `cost_at_nominal`: the surrogate's; not finite where it has none.
void decide_by_true_model(Calibration& out, const Problem& problem, const ForwardModel& true_model, std::span<const Proposal> ranked, std::size_t wanted,
                          double cost_at_nominal, int threads, const CalibrationProgress& progress = {});

/// Mean over the observations of |difference| / |history|, Euclidean norms over time; both (condition, sensor, time).
double relative_difference(const Problem& problem, const Eigen::VectorXd& difference, std::span<const double> history);

/// Fills out.mesh of a calibration that was decided with this correction: its histories and scores without it. Marks the candidates outside the emulator's box
/// and takes over the correction's reservations. An empty correction changes nothing. out.mesh.without is the caller's.
void report_correction(Calibration& out, const Problem& problem, const MeshCorrection& correction);

/// The sentences of every calibration's artefact for people.
struct CalibrationWords {
  std::string meaning;  ///< what a value of its product means
  std::string mesh;     ///< what the correction for the mesh did; empty without one
};

/// The keys of every calibration's artefact, with the method's `own` keys after `sensors`.
Json calibration_json(const Calibration& calibration, const Problem& problem, const Json& own, const CalibrationWords& words, const Provenance& provenance);

/// Writes METHOD.nc, then METHOD.json with `json`, into `out_dir`. METHOD.nc: time; calibrated, nominal
/// (condition, sensor, time), where predictions are corrected for the mesh calibrated_working_mesh and nominal_working_mesh too; record_time; record_mean,
/// band_low, band_high (condition, sensor, record_time).
void write_calibration(const std::string& method, const Calibration& calibration, const Problem& problem, const Json& json, const Provenance& provenance,
                       const std::filesystem::path& out_dir);

}  // namespace calomel
