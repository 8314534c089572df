#pragma once
/// Records and simulations on one coarse grid: both go through the same anti-alias filter, so that a dense covariance of all
/// values of all gauges can be factored.
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <optional>
#include <span>
#include <vector>

#include "inverse/data/problem.hpp"

namespace calomel {

/// One coarse value of a series: a weighted sum of record samples with weights that sum to 1.
struct Window {
  double time = 0;                 ///< its middle [s]
  std::vector<std::size_t> index;  ///< record samples, ascending
  std::vector<double> weight;
};

/// Linear map from record samples, and from a model's values, to coarse values. Every `factor` samples make one value; the filter is a Hann window of
/// twice that length, w(d) = cos^2(pi d / (2 factor)), |d| < factor, which lets half the amplitude through at the coarse Nyquist frequency and
/// nothing at twice it (Harris 1978, Proc. IEEE 66, 51). Absent samples have no weight; a window that keeps less than half of what the record has on average is
/// left out.
class Decimation {
 public:
  /// The smallest factor that leaves at most `most_values` values over all observations and whose Nyquist frequency is not above `band` [Hz].
  Decimation(const Problem& problem, std::size_t most_values, std::optional<double> band = {});

  [[nodiscard]] std::size_t size() const { return std::size_t(map_.rows()); }
  [[nodiscard]] std::size_t factor() const { return factor_; }
  /// Half the length of a window [s]: the distance of two.
  [[nodiscard]] double half_window() const {
    return record_time_.size() < 2 ? 1 : double(factor_) * (record_time_.back() - record_time_.front()) / double(record_time_.size() - 1);
  }
  [[nodiscard]] std::size_t observations() const { return windows_.size(); }
  /// Windows of an observation of the problem, and the place of the first in a vector of values.
  [[nodiscard]] std::span<const Window> windows(std::size_t observation) const { return windows_[observation]; }
  [[nodiscard]] std::size_t offset(std::size_t observation) const { return offsets_[observation]; }
  /// Record times [s].
  [[nodiscard]] const std::vector<double>& record_time() const { return record_time_; }
  /// Middles of all windows, (size).
  [[nodiscard]] Eigen::VectorXd times() const;

  /// histories: (values of the model, n); result: (size, n).
  [[nodiscard]] Eigen::MatrixXd apply(const Eigen::MatrixXd& histories) const { return map_ * histories; }
  /// A record of one observation, (record times); a value whose samples are partly absent takes the rest, NaN where less than half is there.
  [[nodiscard]] Eigen::VectorXd apply_record(std::size_t observation, std::span<const double> record) const;

 private:
  std::size_t factor_ = 1;
  std::vector<double> record_time_;
  std::vector<std::vector<Window>> windows_;
  std::vector<std::size_t> offsets_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> map_;  ///< (size, values of the model)
};

/// What a delay by 1 s does to a history to first order, -dx/dt by differences of its neighbours, in the unit of x per second; NaN beside a value that is
/// absent. history, times: equally many, at least two.
[[nodiscard]] std::vector<double> change_when_late(std::span<const double> history, std::span<const double> times);

/// Covariance of the windows for noise of unit variance on the record grid: (1 - white) exp(-|t - t'| / time) + white [t = t'].
/// `time` 0 is white noise. With `zeroed` the noise of the sample at `zero_time` (not later than any other) is subtracted from all:
/// c(t, t') - c(t, t0) - c(t0, t') + c(t0, t0). Result: (windows, windows).
Eigen::MatrixXd filtered_covariance(std::span<const Window> windows, std::span<const double> record_time, double time, double white, bool zeroed = false,
                                    double zero_time = 0);

}  // namespace calomel
