#pragma once
/// What a liquid law of its own sees of a block: many points at one instant. Plain arrays, because the kernels of every
/// instruction set fill them.
#include <cstddef>

namespace calomel {

struct LiquidPoints {
  std::size_t count = 0;
  double dt = 0;                          ///< since the instant before [s]
  const double* strain = nullptr;         ///< (count) volumetric strain now [-]
  const double* strain_before = nullptr;  ///< (count) one step earlier [-]; before the first step by the initial velocity
  const double* heating = nullptr;        ///< (count) p0, the heating pressure put in so far [Pa]
  double* pressure = nullptr;             ///< (count) in: one step earlier; out: now, compression positive [Pa]
  double* state = nullptr;                ///< variable k of point i is state[k * stride + i]
  std::size_t stride = 0;
};

}  // namespace calomel
