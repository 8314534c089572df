#pragma once
/// Standard deviations of sparse polynomial expansion calibration: its last rounds on drawn records and runs.
#include "inverse/drawn_errors.hpp"
#include "inverse/spe.hpp"
#include "inverse/spe/known_runs.hpp"

namespace calomel {

/// What the runs that were made say of one more: their histories kriged over the parameters, which takes the roughness of single runs off.
class RunEmulator {
 public:
  /// theta: (n_parameters, runs), two or more; histories: (values, runs).
  RunEmulator(const std::vector<Parameter>& parameters, const Eigen::MatrixXd& theta, const Eigen::MatrixXd& histories);
  [[nodiscard]] Eigen::VectorXd history(std::span<const double> theta) const { return histories_ * kriging_.weights(theta); }
  [[nodiscard]] const Kriging& kriging() const { return kriging_; }

 private:
  Kriging kriging_;
  Eigen::MatrixXd histories_;
};

/// For each of options.draws records the last rounds are gone through anew, the true model being the emulator with the shift and, in each run, an error of its own: all
/// known runs are priced, the box of the last round is put about the best of them, new runs are made there, some of the last surrogates are fitted with their
/// weights of the norm, searched and their candidates run, until the best no longer lies at the box's edge; the best run wins. Each pair is left out in turn, and sought in the same way. Fills out.spread.
void spread_spe(SpeSummary& out, const Problem& problem, const KnownRuns& known, const Bounds& box, const MeshPairs& pairs, const std::function<AnswerErrors()>& errors,
                const SpeOptions& options, std::uint64_t seed, int threads, const CalibrationProgress& progress);

}  // namespace calomel
