#pragma once
/// The runs of the true model that sparse polynomial expansion calibration is trained on: those of the campaign, and those that it adds.
#include <Eigen/Core>
#include <vector>

#include "forward/campaign/archive.hpp"
#include "forward/emulator/mesh_correction.hpp"
#include "inverse/calibration/calibration.hpp"
#include "forward/surrogate/feasibility.hpp"
#include "inverse/spe/surrogates.hpp"

namespace calomel {

class KnownRuns {
 public:
  /// The campaign's usable runs, split by `seed` as the train stage does. All but `seed` outlive the object.
  /// Errors: InputError for fewer than 8 usable runs.
  KnownRuns(const Problem& problem, const Archive& archive, const Objective& objective, const SpeOptions& options, std::uint64_t seed);
  /// A run that failed shows where runs fail; one of a known place (in units of `box`) adds nothing. Returns whether it joined.
  bool add(const std::vector<double>& theta, const Prediction& run, bool held_out, const Bounds& box);
  /// Each run's misfit: of its history and the correction at its point, null or empty for none; of runs added later too. Errors: InputError when a misfit of
  /// the campaign has no logarithm and needs one.
  void price(const MeshCorrection* correction);

  /// Runs inside `box` at their points of it scaled to the unit box. `whole`: it is the whole box of the bounds, where the campaign's rows are
  /// weighted by its design's density; in a part of it all rows weigh the same.
  [[nodiscard]] ScatteredData data(const Bounds& box, bool whole) const;
  /// Priced runs, best first; of the campaign only the best `of_campaign`.
  [[nodiscard]] std::vector<Proposal> ranked(std::size_t of_campaign) const;
  /// The run that is best without any correction.
  [[nodiscard]] std::vector<double> best_without_correction() const;
  /// History at a run's point. Contract: it is a known run's.
  [[nodiscard]] const Eigen::VectorXf& history(const std::vector<double>& theta) const;
  [[nodiscard]] bool knows(const std::vector<double>& theta) const { return find(theta) != nullptr; }
  [[nodiscard]] Feasibility feasibility() const;
  [[nodiscard]] std::size_t excluded() const { return excluded_; }
  [[nodiscard]] std::size_t added() const;

 private:
  struct Run {
    std::vector<double> theta;
    Eigen::VectorXf history;
    bool held_out = false, of_campaign = false;
    double cost = 0, cost_without = 0;  ///< with and without the correction
  };
  void price(Run& run) const;
  [[nodiscard]] bool usable(const Run& run) const;
  [[nodiscard]] const Run* find(const std::vector<double>& theta) const;
  const Problem& problem_;
  const Archive& archive_;
  const Objective& objective_;
  const SpeOptions& options_;
  const MeshCorrection* correction_ = nullptr;
  std::vector<Run> runs_;
  std::vector<std::pair<std::vector<double>, bool>> seen_;  ///< all points that were run, and whether the run failed
  std::size_t excluded_ = 0;
};

}  // namespace calomel
