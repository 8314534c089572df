#pragma once
/// Whether the true model agrees with the emulator, in the emulator's own deviations.
#include <cstdint>
#include <vector>

#include "inverse/posterior/posterior_fit.hpp"

namespace calomel {

inline constexpr std::uint64_t check_stream = 0x7c0de;  ///< of a seed, for the draws of a check: other ones than those that the emulator is trained at

/// A run that the emulator was not trained on.
struct CheckedRun {
  std::vector<double> theta;
  int level = 0;
  bool done = false;
  double distance = 0;  ///< |run - emulator| / |run| on the posterior's grid
  double score = 0;     ///< mean square of the difference over what the emulator promises of a run's there: noise and its own variance; expectation 1
};

struct TrueModelCheck {
  std::vector<CheckedRun> runs;
  int done = 0;      ///< number of runs that came through
  double score = 0;  ///< mean over the runs done
  /// Standard deviation of that mean if the emulator is right, by its effective number of values and that of the squares from which the noise was estimated.
  double score_sd = 0;
  double p_value = 1;               ///< share of such means that would be as great if the emulator is right: Fisher's F of those two numbers
  double log_likelihood_shift = 0;  ///< root mean square over fine runs of (log likelihood by the run - log likelihood by the emulator)
  bool holds = false;               ///< p_value above 0.001
};

/// Runs the true model at the mode and at `draws` from the posterior, u (box.size(), n): `fine` on the finest mesh, `coarse` on the next. Draws are taken in
/// their order; where they are too few, from the first again.
[[nodiscard]] TrueModelCheck check_by_true_model(const PosteriorInputs& in, const PosteriorFit& fit, const Eigen::MatrixXd& draws, int coarse, int fine);

}  // namespace calomel
