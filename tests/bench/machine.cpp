#include "tests/bench/machine.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <numeric>
#include <thread>
#include <vector>

#include "forward/solver/step_barrier.hpp"

namespace calomel {

namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// Twelve chains hide the latency of four cycles on two units with vectors to spare. Converges to 1, far from denormals. Kept whole for each instruction set,
// because code for one must not be inlined into another's.
#define CALOMEL_CHAINS(name, bytes, attributes)                                  \
  template <class R>                                                             \
  attributes __attribute__((noinline)) double name(long repeats) {               \
    typedef R V __attribute__((vector_size(bytes)));                             \
    const V x = V{} + R(0.75), y = V{} + R(0.25);                                \
    V a[12];                                                                     \
    for (int k = 0; k < 12; ++k) a[k] = V{} + R(k);                              \
    for (long i = 0; i < repeats; ++i) {                                         \
      _Pragma("GCC unroll 12") for (int k = 0; k < 12; ++k) a[k] = a[k] * x + y; \
    }                                                                            \
    double sum = 0;                                                              \
    for (int k = 0; k < 12; ++k) sum += double(a[k][0]);                         \
    return sum;                                                                  \
  }
CALOMEL_CHAINS(chains16, 16, )
#if defined(__x86_64__)
CALOMEL_CHAINS(chains32, 32, __attribute__((target("avx2,fma"))))
CALOMEL_CHAINS(chains64, 64, __attribute__((target("avx512f,avx512vl,avx512dq,prefer-vector-width=512"))))
#endif
#undef CALOMEL_CHAINS

template <class R>
double (*chains(int vector_bytes))(long) {
  if (vector_bytes == 16) return chains16<R>;
#if defined(__x86_64__)
  if (vector_bytes == 32 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return chains32<R>;
  if (vector_bytes == 64 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")) return chains64<R>;
#endif
  return nullptr;
}

/// Best time [s] of `repeats` calls of body(thread) on all threads at once.
template <class Body>
double best_seconds(int repeats, int threads, Body&& body) {
  double best = 1e300;
  StepBarrier barrier(threads);
  const auto work = [&](int t) {
    for (int repeat = 0; repeat < repeats; ++repeat) {
      barrier.arrive_and_wait();
      const double t0 = now();
      body(t);
      barrier.arrive_and_wait();
      if (t == 0) best = std::min(best, now() - t0);
    }
  };
  std::vector<std::jthread> pool;
  for (int t = 1; t < threads; ++t) pool.emplace_back(work, t);
  work(0);
  pool.clear();
  return best;
}

}  // namespace

double read_bandwidth(int threads) {
  const std::size_t size = std::size_t(96) << 20, share = size / std::size_t(threads);  // doubles: 768 MB in all
  const std::vector<double> a(size, 1.0);
  std::atomic<double> total = 0;
  const double seconds = best_seconds(5, threads, [&](int t) {
    const double* p = a.data() + share * std::size_t(t);
    std::array<double, 16> s{};
    for (std::size_t i = 0; i + 16 <= share; i += 16)
      for (std::size_t k = 0; k < 16; ++k) s[k] += p[i + k];
    total = total + std::accumulate(s.begin(), s.end(), 0.0);
  });
  return total > 0 ? double(size) * sizeof(double) / seconds / 1e9 : 0;
}

template <class R>
double peak_arithmetic(int vector_bytes, int threads) {
  const auto loop = chains<R>(vector_bytes);
  if (!loop) return 0;
  constexpr long repeats = 100'000;  // under a millisecond: some of them are undisturbed on a busy machine too
  std::atomic<double> total = 0;
  const double seconds = best_seconds(200, threads, [&](int) { total = total + loop(repeats); });
  return total > 0 ? double(threads) * double(repeats) * 12 * 2 * (vector_bytes / double(sizeof(R))) / seconds / 1e9 : 0;
}

template double peak_arithmetic<float>(int, int);
template double peak_arithmetic<double>(int, int);

}  // namespace calomel
