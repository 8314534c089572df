#pragma once
/// A loop over independent indices on a few threads. Results never depend on the number of threads, because every
/// index writes only its own place.
#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace calomel {

/// Number of threads to use when the user gave none: all that the machine shows.
inline int default_threads() { return std::max(1u, std::thread::hardware_concurrency()); }

/// body(i) for i in [0, n), each once, on at most `threads` threads. The first exception is rethrown after all have stopped.
template <class Body>
void parallel_for(std::size_t n, int threads, Body&& body) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr error;
  std::mutex lock;
  const auto work = [&] {
    for (std::size_t i; (i = next.fetch_add(1)) < n;) try {
        body(i);
      } catch (...) {
        const std::lock_guard guard(lock);
        if (!error) error = std::current_exception();
        next = n;
      }
  };
  const std::size_t workers = std::min<std::size_t>(n, std::size_t(std::max(1, threads)));
  std::vector<std::jthread> pool;
  for (std::size_t t = 1; t < workers; ++t) pool.emplace_back(work);
  work();
  pool.clear();
  if (error) std::rethrow_exception(error);
}

}  // namespace calomel
