#pragma once
/// The noise of single pulses, estimated from their repeats: y_{s,r}(t) = f_s(t) + (a_r - 1) g_s(t) + b_s + e_{s,r}(t).
#include <Eigen/Core>
#include <vector>

#include "inverse/data/decimation.hpp"
#include "inverse/data/recordings.hpp"

namespace calomel {

/// Noise of one observation on its coarse grid: e = m(t) u(t), u of unit variance on the record grid with correlation
/// (1 - white) exp(-|dt| / time) + white [dt = 0], m^2 its variance, modulated in time.
struct SeriesNoise {
  int pulses = 0;
  Eigen::VectorXd present;     ///< pulses that have a value at the windows (n), at least 1: fewer where some are cut short
  double time = 0;             ///< correlation time [s]; 0 = white
  double white = 1;            ///< share of the variance without memory
  Eigen::VectorXd modulation;  ///< m at the windows (n), in the data's unit
  double zero_modulation = 0;  ///< m at the sample that was set to zero
  bool zeroed = false;         ///< every pulse is exactly 0 at its first sample, at t = 0
  bool given = false;          ///< from recordings.noise, not from repeats
  double freedom = 0;          ///< independent squares that its scale was estimated from; infinity when it was given
  Eigen::MatrixXd pulse;       ///< covariance of one pulse's noise on the windows (n, n)
  double mean_energy = 1;      ///< mean of a_r over the pulses that this gauge has
  [[nodiscard]] double sd() const { return modulation.size() ? std::sqrt(modulation.squaredNorm() / double(modulation.size())) : 0; }
};

struct ReplicateNoise {
  std::vector<SeriesNoise> series;  ///< as Problem::observations
  std::vector<int> pulses;          ///< pulse numbers
  Eigen::MatrixXd energy;           ///< relative energy a_r (condition, pulse); 1 where it is not known; mean 1 over the pulses of a condition
  double energy_sd = 0;             ///< of a_r, its own noise taken off
  /// Mean square of the difference between the means of the earlier and the later half of the pulses over what independent pulses would give: 1 when the
  /// noise of the mean falls with the number of pulses, more when it drifts. 1 where no gauge has four pulses.
  double split_half = 1;
};

/// Maximum likelihood of (time, white) for residuals with a common scale, (windows, pulses), given the modulation; `record_step` [s].
struct CorrelationFit {
  double time = 0, white = 1;
  double log_likelihood = 0;
  double time_se = 0;  ///< standard error of ln(time) from the curvature; infinity for white noise
};
CorrelationFit fit_correlation(const Eigen::MatrixXd& normalised, std::span<const Window> windows, std::span<const double> record_time, bool zeroed,
                               double zero_time);

/// energy_slope: gradient of the coarse values with respect to the relative pulse energy (grid.size()), or empty: the mean record replaces it, as if strain
/// were proportional to energy. Where there is one, the better of the two is taken by the scatter that it explains. Only gauges with two or more pulses are
/// estimated from; the others take recordings.noise with recordings.noise_time. `options` and `problem` belong to `recordings`. Errors: InputError for a single
/// pulse without noise.
ReplicateNoise learn_noise(const Problem& problem, const Decimation& grid, const Recordings& recordings, const RecordingOptions& options,
                           const Eigen::VectorXd& energy_slope);

}  // namespace calomel
