#pragma once
/// What a calibration compares: mean records with their bands on one side, a model's histories on the other.
#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "forward/model.hpp"
#include "inverse/data/recordings.hpp"

namespace calomel {

/// Where a model's history is read for one record sample: a weighted sum of up to four neighbours.
struct Stencil {
  std::array<std::uint32_t, 4> index{};
  std::array<double, 4> weight{};
};

/// Mean record and band of one sensor under one condition, on consecutive record times within the simulation's.
struct Observation {
  std::size_t condition = 0, sensor = 0;  ///< indices into the model's shape
  int pulses = 0;                         ///< pulses with any sample
  double peak = 0;                        ///< largest |mean|
  double mean_square = 0;                 ///< of the mean, over the samples compared
  double noise_square = 0;                ///< what noise alone would leave of that, by the scatter of the pulses or the noise given
  std::vector<double> mean;               ///< (n_times), NaN = absent
  std::vector<double> low, high;          ///< (n_times) band; NaN where there is none
  std::vector<char> compared;             ///< (n_times) the mean is there
  std::vector<char> banded;               ///< (n_times) counts in accuracy and delta2
  std::size_t narrow = 0;                 ///< samples left out because their band is narrower than 1 % of the peak
  std::size_t bandless = 0;               ///< samples left out because one pulse is left there and no noise is given
  std::size_t samples = 0;                ///< compared
  std::size_t banded_samples = 0;

  // The same in single precision for the batch objective; lanes that do not count have weight 0.
  std::vector<float> mean_f, weight_f, low_f, high_f, inverse_width_f;
};

/// Recordings against a model.
struct Problem {
  ModelShape shape;
  std::string unit = "strain";  ///< of the values
  double mae_scale = 1e6;       ///< value -> unit of mae: microstrain for strain, 1 otherwise
  std::string mae_unit = "microstrain";
  std::vector<double> time;       ///< record times compared [s], within the overlap
  std::vector<Stencil> stencils;  ///< (n_times)
  bool same_grid = false;         ///< record times are consecutive simulation times, from index `first`
  std::size_t first = 0;
  std::size_t outside = 0;                ///< record times outside of the simulation, not compared
  std::vector<Observation> observations;  ///< recorded sensors in the model's order, condition by condition, but for those that are dead
  std::vector<std::string> dead;          ///< labels of gauges that record nothing but noise, which are left out
  std::vector<std::string> warnings;

  [[nodiscard]] std::string label(const Observation& o) const;
};

/// The warning about dead gauges, of which there is at least one.
std::string plain_dead(std::span<const std::string> labels);

/// Band of each sensor: mean +- t(0.975, n - 1) s, with s the sd over its n pulses; `band = "mean"` divides s by sqrt(n); one
/// pulse: +- 1.96 noise. A gauge is dead whose mean record is 0 throughout, or never changes where another's does, or has less than three times the mean square
/// that noise alone would leave and less than a tenth of the root mean square of the middle one of all gauges. Errors: InputError when recordings and
/// simulation do not overlap, or share one of several samples alone, a condition is not the model's, all mean records are 0, or noise is missing for a sensor
/// with one pulse.
Problem make_problem(const ModelShape& shape, const Recordings& recordings, const RecordingOptions& options);

/// Width of the 95 % band of n values, in units of their sd: t(0.975, n - 1), over sqrt(n) for the mean.
double band_factor(int n, bool of_the_mean);

/// One sensor under one condition.
struct SensorScore {
  std::string condition, name;
  double accuracy = 0;  ///< [%] share of banded samples strictly inside; NaN when there is none
  double mae = 0;       ///< [microstrain], or the data's unit
  double rrmse = 0;     ///< |simulation - mean record| / |mean record|, Euclidean norms
  double excess = 0;    ///< max (y - high)+ / (high - low) + max (low - y)+ / (high - low)
  std::size_t samples = 0, banded = 0;
};

/// A model's histories against the recordings. Averages are over sensors (and conditions), each with equal weight.
struct Score {
  bool ok = false;                   ///< false: the run failed, nothing else is filled
  std::vector<SensorScore> sensors;  ///< as Problem::observations
  std::size_t banded_sensors = 0;    ///< with at least one banded sample; 0: accuracy is not defined (and 0)
  double accuracy = 0, mae = 0, nrmse = 0;
  double delta1 = 0;  ///< sum of rrmse over sensors (eq. RRMSE of the seed paper)
  double delta2 = 0;  ///< sum of excess over sensors (eq. Linf)
};

/// values: (condition, sensor, time) as ModelShape::at.
Score score(const Problem& problem, std::span<const double> values);

/// A history on the record times. history: (n_times of the model); result: (n record times compared).
std::vector<double> on_record_times(const Problem& problem, std::span<const double> history);

/// (condition, sensor, record time) arrays of the bands over all record times compared, NaN where nothing is recorded.
struct BandArrays {
  std::vector<double> mean, low, high;
};
BandArrays band_arrays(const Problem& problem);

}  // namespace calomel
