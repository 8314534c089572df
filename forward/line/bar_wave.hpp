#pragma once
/// A wave that runs along a bar past a first gauge, carried in the frequency domain to places farther on.
#include <complex>
#include <functional>
#include <span>
#include <vector>

#include "forward/line/signal.hpp"

namespace calomel {

/// u(x, t) = sum_n U_n exp(i (omega_n t - k(omega_n) x)), U the spectrum of the record at x = 0. Waves that come back from the far end are not in it. Before
/// its first sample the record is taken as 0; after its last it descends to 0 along half a cosine, so that what is predicted holds until its end plus the
/// delay.
class BarWave {
 public:
  /// `longest`: the longest delay that will be requested [s].
  BarWave(const Signal& drive, double longest);

  /// Angular frequencies [rad/s] above 0, (frequencies).
  [[nodiscard]] const std::vector<double>& omega() const { return omega_; }
  /// The record at `distance` [m] and later by `delay` [s], on the drive's clock and interval, (samples() ). wavenumber: (frequencies) [rad/m]; its imaginary
  /// part, at most 0, attenuates.
  [[nodiscard]] std::vector<double> at(double distance, std::span<const std::complex<double>> wavenumber, double delay) const;
  /// Samples of the record and what is appended to it.
  [[nodiscard]] std::size_t samples() const { return spectrum_.size(); }

 private:
  std::vector<double> omega_;
  std::vector<double> spectrum_;  ///< half-complex, as GSL stores it
};

/// Values of `samples`, at begin + i interval, on the times `time` [s]: the samples themselves where all times fall on them (to 1e-6 of the interval), else a
/// cubic spline. 0 before begin. Errors: ContractFailure for a time after the last sample.
std::vector<double> resampled(double begin, double interval, std::span<const double> samples, std::span<const double> time);

}  // namespace calomel
