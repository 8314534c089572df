#pragma once
/// Pairs of runs of the true model for calibrations that decide by it: where they are made, and the mesh's error that they tell.
#include <functional>
#include <span>
#include <vector>

#include "base/options.hpp"
#include "forward/campaign/added_runs.hpp"
#include "forward/campaign/archive.hpp"
#include "inverse/calibration.hpp"
#include "inverse/likelihood/mesh_error.hpp"
#include "inverse/shifted_model.hpp"

namespace calomel {

/// Where a calibration has its runs of the true model made.
struct RunSource {
  /// Runs points (n_parameters, n), those on the finer mesh too where `with_fine` says so (n); see AddedRuns::run. Empty: none can be made so.
  std::function<std::vector<AddedRun>(const Eigen::MatrixXd& thetas, const std::vector<bool>& with_fine)> run;
  bool has_finer = false;
};

/// The values of a run's history, as a vector.
Eigen::VectorXd values_of(const std::vector<float>& history);

/// Mean over the observations of |difference| / |history|, Euclidean norms over time; both (condition, sensor, time).
double relative_difference(const Problem& problem, const Eigen::VectorXd& difference, std::span<const double> history);

/// Of the options mesh_pairs and mesh_beyond of a calibration.
FieldInfo mesh_pairs_info();
FieldInfo mesh_beyond_info();

/// Runs that no journal keeps. `finer` may be null; the models outlive what is returned.
RunSource without_journal(const ForwardModel& working, const ForwardModel* finer, int threads);

/// Points of `pool`, each time the one farthest from `chosen` and those taken before, in units of the bounds, until `chosen` has n of them or the rest lie
/// within a hundredth of one another.
void farthest_first(std::vector<Proposal>& chosen, const std::vector<Proposal>& pool, std::size_t n, const Bounds& bounds);

/// Runs of the campaign with their true costs, best first; those with no finite cost are left out.
std::vector<Proposal> ranked_runs(const Archive& archive, const std::function<double(std::span<const double> theta, std::span<const double> values)>& cost);

/// Points for the first pairs: `given` in their order, then farthest first of the ten best of `ranked`; n of them. They follow from the arguments alone.
std::vector<std::vector<double>> first_pair_points(const std::vector<std::vector<double>>& given, const std::vector<Proposal>& ranked, std::size_t n, const Bounds& bounds);

/// A pair as if it had not been made: its place, the records that it would have given, (values), and the mesh's error that the others tell.
struct LeftOutPair {
  std::vector<double> theta;
  Eigen::VectorXd records;
  MeshError mesh;
};

/// Runs made for one calibration and the mesh's error that its pairs tell.
class MeshPairs {
 public:
  /// `wanted`: pairs at most, 0 where the source has no finer mesh. What is run is told to `memory`. All outlive the object.
  MeshPairs(const ModelShape& shape, const RunSource& source, const RememberingModel& memory, int wanted, double beyond);
  /// Runs `points`, the first `pairs` of them (or as many as are left) on the finer mesh too, and learns from them.
  std::vector<AddedRun> add(const std::vector<std::vector<double>>& points, std::size_t pairs);

  /// Runs those of the first n of `points` that are not known yet, unpaired.
  void run_unknown(std::span<const Proposal> points, std::size_t n);

  /// Wall time of all this [s].
  [[nodiscard]] double seconds() const { return seconds_; }
  /// Where pairs were asked for.
  [[nodiscard]] const std::vector<std::vector<double>>& places() const { return asked_at_; }
  /// Pairs that may still be made.
  [[nodiscard]] int left() const { return wanted_ - asked_; }
  [[nodiscard]] int asked() const { return asked_; }
  [[nodiscard]] const MeshError& mesh() const { return mesh_; }
  /// Each of the pairs that came through, left out; nothing with fewer than three.
  [[nodiscard]] std::vector<LeftOutPair> left_out() const;
  /// All runs whose working mesh came through: (n_parameters, n) and (values, n).
  [[nodiscard]] const Eigen::MatrixXd& thetas() const { return theta_; }
  [[nodiscard]] const Eigen::MatrixXd& working() const { return working_; }
  /// Whether a point within 1e-3 of the bounds has been paired.
  [[nodiscard]] bool paired(const std::vector<double>& theta) const;

  /// Fills out.mesh of a calibration that was decided with the shift: its histories and scores without it, and a sentence.
  void describe(Calibration& out, const Problem& problem) const;

 private:
  const ModelShape& shape_;
  const RunSource& source_;
  const RememberingModel& memory_;
  int wanted_ = 0, asked_ = 0, failed_ = 0;
  double beyond_ = 1, seconds_ = 0;
  MeshError mesh_;
  std::vector<std::vector<double>> asked_at_;
  Eigen::MatrixXd theta_, working_, pair_theta_, pair_working_, difference_;
};

}  // namespace calomel
