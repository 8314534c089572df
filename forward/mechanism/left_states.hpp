#pragma once
/// What one pulse leaves moving in the target: states of the model's own free motion long after it, in mercury that never gives way.
#include <cstddef>
#include <vector>

#include "forward/solver/explicit_solver.hpp"

namespace calomel {

/// Motion of the whole target at one instant.
struct LeftState {
  std::vector<Vec3> displacement;  ///< per mesh node [m]
  std::vector<Vec3> velocity;      ///< per mesh node [m/s]
};

/// Collects such states from one long run. State k is that at t_k after the pulse, t_k = t_0 + T frac(k phi), k = 1 to `count`, with the golden ratio phi:
/// distributed over T without a period. t_0 is the end of the record and half a low pass more, T three records and at least 2 ms. Each is low-passed in
/// time, so that it has no tones that have died away when the next pulse comes; a mean over time of free motions is a free motion. The mean of all is taken off
/// each: with it goes what the heat holds at rest.
class LeftStates {
 public:
  static constexpr std::size_t count = 64;  ///< 2 B T, which determine a motion with tones up to B = 16 kHz that is watched for T = 2 ms

  /// record: how long a record is; output_interval: of the run, of which pictures are a whole number apart; highest: tones up to here are kept, none is left
  /// above thrice that [Hz].
  LeftStates(double record, double output_interval, double highest = 10e3);

  [[nodiscard]] double end() const { return end_; }                          ///< of the run that is needed [s]
  [[nodiscard]] double interval() const { return interval_; }                ///< between its pictures [s]
  [[nodiscard]] const std::vector<double>& times() const { return times_; }  ///< t_k [s]
  void take(const FieldSnapshot& picture);
  /// Once the run has ended.
  [[nodiscard]] std::vector<LeftState> states() const;

 private:
  double interval_, end_ = 0;
  std::vector<double> taps_;  ///< of the low pass, an odd number
  std::vector<double> times_;
  std::vector<LeftState> sums_;
};

/// Their sum with these shares.
[[nodiscard]] LeftState together(const std::vector<LeftState>& states, const std::vector<double>& shares);

}  // namespace calomel
