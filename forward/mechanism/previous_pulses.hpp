#pragma once
/// What is left of the pulses before this one: the target still rings in its low wet modes when the record starts, and the gauges are set to zero there. In strain
///   s(t) = r(t) - r(0),   r = sum_j phi_sj (A_j cos w_j t + B_j sin w_j t) exp(-zeta_j w_j t),
/// is added to the history of gauge s. w_j, zeta_j and phi_sj are those of the at most 8 strongest modes below 10 kHz in the ring-down of the model itself, after the record's
/// end, with mercury that never gives way; phi_sj is the strain that one pulse has left in the mode at the gauge when its record ends. A_j and B_j are common to all gauges,
/// modes in the order of their frequencies. Off: all 0 (physics.md section 3).
#include "forward/mechanism/mechanism.hpp"

namespace calomel {

struct WetMode {
  double omega;               ///< [rad/s]
  double decay;               ///< zeta omega [1/s]
  std::vector<double> shape;  ///< (sensor), strain at `begin` [-]
};

/// The strongest modes, at most `most`, below `highest` [Hz] of what rings after `begin` [s], in the order of their frequencies. All gauges share poles, from the shift invariance of
/// their common signal space (Hua and Sarkar 1990, IEEE Trans. Acoust. Speech Signal Process. 38, 814; state-space form of Kung, 1978) after a low pass; amplitudes by
/// least squares, turned to the phase that makes them real as nearly as may be.
[[nodiscard]] std::vector<WetMode> wet_modes(const RingDown& ring_down, double begin, std::size_t most = 8, double highest = 10e3);

MechanismEntry previous_pulses();

}  // namespace calomel
