#include "forward/solver/thread_shares.hpp"

#include <algorithm>

#include "forward/solver/kernel.hpp"
#include "forward/solver/layout.hpp"

namespace calomel {

namespace {

/// Cost of the blocks before each of [begin, end], from `begin` on.
std::vector<double> cost_before(const Layout& layout, bool own_law, std::size_t begin, std::size_t end) {
  std::vector<double> cost{0};
  for (std::size_t b = begin; b < end; ++b) cost.push_back(cost.back() + block_cost(layout.blocks[b], own_law));
  return cost;
}

double greatest_share(const Layout& layout, bool own_law, std::size_t begin, std::size_t end, int threads) {
  const auto cost = cost_before(layout, own_law, begin, end);
  const auto first = thread_shares(layout, own_law, begin, end, threads);
  double greatest = 0;
  for (std::size_t t = 0; t + 1 < first.size(); ++t) greatest = std::max(greatest, cost[first[t + 1] - begin] - cost[first[t] - begin]);
  return greatest;
}

}  // namespace

std::vector<std::size_t> thread_shares(const Layout& layout, bool own_law, std::size_t begin, std::size_t end, int threads) {
  const auto cost = cost_before(layout, own_law, begin, end);
  const auto filled = [&](double room) {  // each thread takes blocks while they fit, the last one what is left
    std::vector<std::size_t> first{begin};
    for (int t = 1; t < threads; ++t) {
      const auto next = std::upper_bound(cost.begin(), cost.end(), cost[first.back() - begin] + room);
      first.push_back(begin + std::size_t(next - cost.begin()) - 1);
    }
    first.push_back(end);
    return first;
  };
  const auto fits = [&](double room) { return cost.back() - cost[filled(room)[std::size_t(threads) - 1] - begin] <= room; };
  double low = 0, high = cost.back() * (1 + 1e-12);
  for (int halving = 0; halving < 40; ++halving) {
    const double middle = 0.5 * (low + high);
    (fits(middle) ? high : low) = middle;
  }
  return filled(high);
}

ThreadChoice useful_threads(const Layout& layout, bool own_law, double lanes, int subcycles, int most) {
  const auto step = [&](int threads) {
    const double fast = greatest_share(layout, own_law, 0, layout.first_slow_block, threads);
    const double slow = greatest_share(layout, own_law, layout.first_slow_block, layout.blocks.size(), threads);
    return lanes * (fast + slow / subcycles) + (threads > 1 ? meeting_cost : 0);
  };
  const double alone = step(1);
  ThreadChoice best;
  for (int t = 2; t <= std::min<int>(most, int(layout.blocks.size())); ++t)
    if (const double gain = alone / step(t); gain > best.gain * (1 + 1e-9) && gain >= least_efficiency * t) best = {t, gain};
  return best;
}

std::size_t runs_at_once(std::size_t left, bool plane_strain) {
  return !plane_strain && double(left) < group_cost ? 1 : std::min<std::size_t>(left, run_lanes);
}

}  // namespace calomel
