#pragma once
/// Where runs are made: threads of this machine, or other machines.
#include <atomic>
#include <cstddef>
#include <functional>
#include <span>

#include "forward/simulation/run_record.hpp"
#include "forward/simulation/run_request.hpp"

namespace calomel {

class Simulator;

class Executor {
 public:
  virtual ~Executor() = default;
  /// Called as each run ends, from any thread, one at a time.
  using Done = std::function<void(std::size_t request, RunRecord record)>;
  /// Makes each of `requests` once and calls `done` with its index. The order is free, but the first requests are begun first. Once `stop` is true no further
  /// run is begun. Errors: the first exception of a run or of `done`, after the runs in progress.
  virtual void make(const Simulator& simulator, std::span<const RunRequest> requests, const Done& done, const std::atomic<bool>* stop) const = 0;
  /// Number of runs made side by side.
  [[nodiscard]] virtual int width() const = 0;
};

/// Runs side by side on threads of this machine, one thread a run.
class ThreadExecutor final : public Executor {
 public:
  explicit ThreadExecutor(int threads) : threads_(threads) {}
  void make(const Simulator& simulator, std::span<const RunRequest> requests, const Done& done, const std::atomic<bool>* stop) const override;
  [[nodiscard]] int width() const override { return threads_; }

 private:
  int threads_;
};

}  // namespace calomel
