#include "forward/simulation/executor.hpp"

#include <mutex>

#include "base/parallel.hpp"
#include "forward/simulation/simulator.hpp"

namespace calomel {

void ThreadExecutor::make(const Simulator& simulator, std::span<const RunRequest> requests, const Done& done, const std::atomic<bool>* stop) const {
  std::mutex one;
  parallel_for(requests.size(), threads_, [&](std::size_t i) {
    if (stop && stop->load()) return;
    RunRecord record = simulator.run(requests[i]);
    const std::lock_guard guard(one);
    done(i, std::move(record));
  });
}

}  // namespace calomel
