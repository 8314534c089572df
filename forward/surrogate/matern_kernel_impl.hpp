// Included once by each matern_kernel_<isa>.cpp inside its own namespace CALOMEL_ISA, so that code for different instruction sets never mixes. No
// standard-library calls in here. The compiler makes vectors of the loops marked simd; sums are its to reorder, nothing else.
#include "forward/surrogate/matern_kernel.hpp"

#define CALOMEL_INLINE inline __attribute__((always_inline))

namespace calomel::CALOMEL_ISA {

/// exp(x) for |x| < 700, beyond which it is that of 700: x = k log 2 + f, |f| < 0.35, the Taylor series of exp(f) to the 13th power, and k added to the
/// exponent. Relative error about 2e-16.
CALOMEL_INLINE double exponential(double x) {
  constexpr double to_integer = 0x1.8p52;  // adding it leaves the nearest integer in the last bits
  x = x < -700 ? -700 : x;
  x = x > 700 ? 700 : x;
  const double shifted = x * 1.44269504088896340736 + to_integer, k = shifted - to_integer;
  const double f = (x - k * 0x1.62e42fefa38p-1) - k * 0x1.ef35793c7673p-45;  // log 2 in two parts, k times the first is exact
  const double f2 = f * f, f4 = f2 * f2;
  const double p0 = (1 + f) + f2 * (1.0 / 2 + f * (1.0 / 6)), p1 = (1.0 / 24 + f * (1.0 / 120)) + f2 * (1.0 / 720 + f * (1.0 / 5040));
  const double p2 = (1.0 / 40320 + f * (1.0 / 362880)) + f2 * (1.0 / 3628800 + f * (1.0 / 39916800)), p3 = 1.0 / 479001600 + f * (1.0 / 6227020800);
  const double p = p0 + f4 * (p1 + f4 * (p2 + f4 * p3));
  const long long exponent = __builtin_bit_cast(long long, shifted) << 52;
  return __builtin_bit_cast(double, __builtin_bit_cast(long long, p) + exponent);
}

void matern_means(const MaternProcess& process, const double* x, std::ptrdiff_t n, double* out, double* scratch) {
  constexpr std::ptrdiff_t columns = matern_padding;
  double* __restrict r2 = scratch;
  double* __restrict here = scratch + process.points;  // (features, columns)
  const double* __restrict weights = process.weights;
  for (std::ptrdiff_t first = 0; first < n; first += columns) {
    const std::ptrdiff_t count = n - first < columns ? n - first : columns;
    // 1. Warped and stretched features of the columns.
    for (std::ptrdiff_t f = 0; f < process.features; ++f) {
      const double kappa = process.kappa[f];
      double u[columns];
      for (std::ptrdiff_t c = 0; c < columns; ++c) u[c] = x[(first + (c < count ? c : 0)) * process.features + f];
      if (kappa < 1e-4 && kappa > -1e-4) {  // the series of gaussian_process.cpp
#pragma omp simd
        for (std::ptrdiff_t c = 0; c < columns; ++c) {
          const double q = u[c] * (1 - u[c]) / 2, cubic = (u[c] - 3 * u[c] * u[c] + 2 * u[c] * u[c] * u[c]) / 12;
          here[f * columns + c] = process.stretch[f] * (u[c] + kappa * q + kappa * kappa * cubic);
        }
      } else {
        const double scale = process.stretch[f] / (1 - exponential(-kappa));
#pragma omp simd
        for (std::ptrdiff_t c = 0; c < columns; ++c) here[f * columns + c] = scale * (1 - exponential(-kappa * u[c]));
      }
    }
    // 2. The weighted kernels.
    for (std::ptrdiff_t c = 0; c < count; ++c) {
      for (std::ptrdiff_t f = 0; f < process.features; ++f) {
        const double* __restrict at = process.at + f * process.points;
        const double a = here[f * columns + c];
        if (f == 0) {
#pragma omp simd
          for (std::ptrdiff_t i = 0; i < process.points; ++i) r2[i] = (at[i] - a) * (at[i] - a);
        } else {
#pragma omp simd
          for (std::ptrdiff_t i = 0; i < process.points; ++i) r2[i] += (at[i] - a) * (at[i] - a);
        }
      }
      double sum = 0;
#pragma omp simd reduction(+ : sum)
      for (std::ptrdiff_t i = 0; i < process.points; ++i) {
        const double r = __builtin_sqrt(r2[i]);
        sum += weights[i] * ((1 + r + r2[i] * (1.0 / 3)) * exponential(-r));
      }
      out[first + c] = sum;
    }
  }
}

}  // namespace calomel::CALOMEL_ISA
