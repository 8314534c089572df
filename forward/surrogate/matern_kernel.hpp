#pragma once
/// The inner loop of a Gaussian process's means, compiled for several instruction sets.
#include <cstddef>

#include "base/instruction_set.hpp"

namespace calomel {

/// Points of a process come in multiples of so many, further ones with weight 0.
inline constexpr std::ptrdiff_t matern_padding = 8;

/// A Gaussian process (gaussian_process.hpp) as the loop wants it.
struct MaternProcess {
  std::ptrdiff_t points, features;  ///< points: a multiple of matern_padding
  const double* at;                 ///< (features, points), the point fastest: sqrt5 * warped feature / length
  const double* weights;            ///< (points)
  const double* kappa;              ///< (features) warps
  const double* stretch;            ///< (features) sqrt5 / length
};

/// out_j = sum_i weights_i (1 + r + r^2 / 3) exp(-r), r = |at_i - stretch * warp(x_j)|, in double precision; exp and the warp to about 1e-15 and
/// 1e-12 relative. x: (n, features), the feature fastest; out: (n); scratch: (points + features * matern_padding).
using MaternMeans = void (*)(const MaternProcess& process, const double* x, std::ptrdiff_t n, double* out, double* scratch);

/// For an instruction set that this processor has.
MaternMeans matern_means(InstructionSet isa);

}  // namespace calomel
