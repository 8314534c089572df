#pragma once
/// The one way to run the true model: a simulator, the store of its runs, and an executor that makes those which are missing.
#include <atomic>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "forward/simulation/executor.hpp"
#include "forward/simulation/run_store.hpp"
#include "forward/simulation/simulator.hpp"

namespace calomel {

class Runs {
 public:
  /// Called before the first run that must be made and after each: runs made, and runs to be made, of one call.
  using Progress = std::function<void(std::size_t done, std::size_t total)>;

  /// All outlive the object. Once `stop` is true no further run is begun.
  Runs(const Simulator& simulator, RunStore& store, const Executor& executor, const std::atomic<bool>* stop = nullptr)
      : simulator_(simulator), store_(store), executor_(executor), stop_(stop) {}

  [[nodiscard]] const Simulator& simulator() const { return simulator_; }
  [[nodiscard]] const RunStore& store() const { return store_; }
  [[nodiscard]] int width() const { return executor_.width(); }

  /// Makes the runs that the store does not hold, the expensive ones first, and keeps each as it ends. A run that is requested twice is made once.
  /// Errors: those of Simulator::run; Interrupted when it was stopped, after the runs in progress.
  void make(std::span<const RunRequest> requests, const Progress& progress = {});
  /// The same, and gives the records in the order of the requests.
  [[nodiscard]] std::vector<RunRecord> get(std::span<const RunRequest> requests, const Progress& progress = {});
  /// One run in double precision that is not kept: a step of a chain, which has its own journal. Errors: those of Simulator::run.
  [[nodiscard]] Prediction evaluate(const RunRequest& request) const { return simulator_.evaluate(request); }

  /// Runs of this object's life that were made, and that were requested and held already.
  [[nodiscard]] std::size_t made() const { return made_; }
  [[nodiscard]] std::size_t reused() const { return reused_; }
  /// Runs of this object's life that were made and failed.
  [[nodiscard]] std::size_t failed() const { return failed_; }

 private:
  const Simulator& simulator_;
  RunStore& store_;
  const Executor& executor_;
  const std::atomic<bool>* stop_;
  std::atomic<std::size_t> made_ = 0, reused_ = 0, failed_ = 0;
};

/// A copy of each request that requests these outputs.
std::vector<RunRequest> wanting(std::span<const RunRequest> requests, const Outputs& wanted);

}  // namespace calomel
