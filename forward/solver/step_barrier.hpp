#pragma once
/// Where the threads of a run meet, two or three times a step.
#include <atomic>
#include <chrono>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace calomel {

/// A barrier for steps that may be shorter than the 50 us that it takes to wake a thread. Who comes early looks again and again for a few times as long and
/// then sleeps: on a busy machine, where the others may not be running at all, little is lost.
class StepBarrier {
 public:
  explicit StepBarrier(int threads) : threads_(threads) {}

  void arrive_and_wait() {
    const int round = round_.load(std::memory_order_acquire);
    if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == threads_) {
      arrived_.store(0, std::memory_order_relaxed);
      round_.store(round + 1, std::memory_order_release);
      round_.notify_all();
      return;
    }
    const auto until = std::chrono::steady_clock::now() + patience;
    do {
      for (int look = 0; look < 32; ++look) {
        if (round_.load(std::memory_order_acquire) != round) return;
        pause();
      }
    } while (std::chrono::steady_clock::now() < until);
    round_.wait(round, std::memory_order_acquire);
  }

 private:
  static constexpr std::chrono::microseconds patience{200};

  static void pause() {
#if defined(__x86_64__)
    _mm_pause();
#endif
  }

  const int threads_;
  alignas(64) std::atomic<int> arrived_{0};
  alignas(64) std::atomic<int> round_{0};  // apart, so that arrivals do not disturb those who look
};

}  // namespace calomel
