#pragma once
/// What the machine can do at best, measured in the same minutes as what is compared with it.

namespace calomel {

/// Read bandwidth [GB/s] over arrays far beyond the caches, best of five.
double read_bandwidth(int threads);

/// Multiplications and additions a second [GFLOP/s] by fused multiply-adds on vectors of 16, 32 or 64 bytes that remain in registers (16: a multiplication and
/// an addition in turn), `threads` threads each on its own, best of two hundred. 0 where the processor has no such vectors.
template <class R>
double peak_arithmetic(int vector_bytes, int threads);

extern template double peak_arithmetic<float>(int, int);
extern template double peak_arithmetic<double>(int, int);

}  // namespace calomel
