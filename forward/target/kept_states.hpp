#pragma once
/// States that earlier pulses leave, as they are made once for many runs.
#include <algorithm>
#include <deque>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "forward/mechanism/left_states.hpp"

namespace calomel {

/// States by what decides them; those made last are kept.
class KeptStates {
 public:
  using States = std::shared_ptr<const std::vector<LeftState>>;

  /// Of this key: as they are kept, or made; where another thread is making them they are waited for. Errors: those of `make`.
  template <class Make>
  States of(const std::string& key, const Make& make) {
    std::promise<States> promise;
    {
      std::unique_lock lock(guard_);
      const auto there = std::find_if(kept_.begin(), kept_.end(), [&](const auto& k) { return k.first == key; });
      if (there != kept_.end()) {
        const auto states = there->second;
        lock.unlock();
        return states.get();
      }
      kept_.emplace_back(key, promise.get_future().share());
      if (kept_.size() > most) kept_.pop_front();
    }
    try {
      const auto states = std::make_shared<const std::vector<LeftState>>(make());
      promise.set_value(states);
      return states;
    } catch (...) {
      promise.set_exception(std::current_exception());
      throw;
    }
  }

 private:
  static constexpr std::size_t most = 4;
  std::mutex guard_;
  std::deque<std::pair<std::string, std::shared_future<States>>> kept_;
};

}  // namespace calomel
