#include "forward/solver/thread_shares.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <thread>

#include "base/random.hpp"
#include "forward/solver/layout.hpp"
#include "forward/solver/step_barrier.hpp"

namespace calomel {
namespace {

/// Blocks of general mercury, whose elements cost 1 each.
Layout layout_of(const std::vector<int>& elements) {
  Layout layout;
  for (const int n : elements) {
    Block block;
    block.liquid = true;
    block.elements.resize(std::size_t(n));
    layout.blocks.push_back(block);
  }
  layout.first_slow_block = layout.blocks.size();
  return layout;
}

double greatest(const std::vector<int>& cost, const std::vector<std::size_t>& first) {
  double most = 0;
  for (std::size_t t = 0; t + 1 < first.size(); ++t)
    most = std::max(most, std::accumulate(cost.begin() + std::ptrdiff_t(first[t]), cost.begin() + std::ptrdiff_t(first[t + 1]), 0.0));
  return most;
}

/// The least greatest share of the blocks from `from` on, by trying all divisions.
double best_greatest(const std::vector<int>& cost, std::size_t from, int threads) {
  if (threads == 1) return std::accumulate(cost.begin() + std::ptrdiff_t(from), cost.end(), 0.0);
  double best = 1e300, mine = 0;
  for (std::size_t to = from; to <= cost.size(); ++to) {
    best = std::min(best, std::max(mine, best_greatest(cost, to, threads - 1)));
    if (to < cost.size()) mine += cost[to];
  }
  return best;
}

TEST(ThreadShares, TheGreatestIsAsSmallAsCanBe) {
  RandomStream random(1, 0);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<int> cost(std::size_t(1 + 8 * random.uniform()));
    for (int& c : cost) c = int(1 + 2047 * random.uniform());
    const int threads = int(1 + 4 * random.uniform());
    const auto first = thread_shares(layout_of(cost), false, 0, cost.size(), threads);
    ASSERT_EQ(first.size(), std::size_t(threads) + 1);
    EXPECT_EQ(first.front(), 0u);
    EXPECT_EQ(first.back(), cost.size());
    EXPECT_TRUE(std::is_sorted(first.begin(), first.end()));
    EXPECT_EQ(greatest(cost, first), best_greatest(cost, 0, threads));
  }
}

TEST(ThreadShares, ASmallBlockBeforeALargeOneDoesNotBringBothToOneThread) {
  const auto first = thread_shares(layout_of({600, 2000}), false, 0, 2, 2);
  EXPECT_EQ(first, (std::vector<std::size_t>{0, 1, 2}));
}

TEST(ThreadShares, StretchesAndEmptyOnesAreSharedToo) {
  EXPECT_EQ(thread_shares(layout_of({5, 5, 5, 5}), false, 2, 4, 2), (std::vector<std::size_t>{2, 3, 4}));
  EXPECT_EQ(thread_shares(layout_of({5, 5}), false, 2, 2, 3), (std::vector<std::size_t>{2, 2, 2, 2}));
}

TEST(UsefulThreads, ASmallRunTakesOneAndALargeOneAll) {
  const auto choice = [](const std::vector<int>& elements, int most) { return useful_threads(layout_of(elements), false, 1, 1, most); };
  EXPECT_EQ(choice({50, 50}, 8).threads, 1);
  EXPECT_EQ(choice({50, 50}, 8).gain, 1);
  const std::vector<int> large(64, 2048);
  EXPECT_EQ(choice(large, 8).threads, 8);
  EXPECT_EQ(choice(large, 1).threads, 1);
  EXPECT_NEAR(choice(large, 2).gain, 2, 0.01);
  EXPECT_LE(choice(large, 200).threads, 64);
}

TEST(UsefulThreads, MoreThanTheBlocksCanFeedAreNotTaken) {
  // One block is most of the work: a second thread takes the rest, and a third would change nothing.
  const auto choice = useful_threads(layout_of({2048, 700, 700}), false, 1, 1, 3);
  EXPECT_EQ(choice.threads, 2);
  EXPECT_LT(choice.gain, 3448.0 / 2048);
}

TEST(RunsAtOnce, FillTheLanesWhereThatCostsLessThanOneByOne) {
  const auto groups = [](std::size_t runs, bool plane_strain) {
    std::vector<std::size_t> out;
    for (std::size_t left = runs; left > 0; left -= out.back()) out.push_back(runs_at_once(left, plane_strain));
    return out;
  };
  EXPECT_EQ(groups(2, true), (std::vector<std::size_t>{2}));
  EXPECT_EQ(groups(10, true), (std::vector<std::size_t>{8, 2}));
  EXPECT_EQ(groups(2, false), (std::vector<std::size_t>{1, 1}));
  EXPECT_EQ(groups(3, false), (std::vector<std::size_t>{1, 1, 1}));
  EXPECT_EQ(groups(4, false), (std::vector<std::size_t>{4}));
  EXPECT_EQ(groups(10, false), (std::vector<std::size_t>{8, 1, 1}));
}

TEST(StepBarrier, NobodyPassesBeforeAllHaveCome) {
  constexpr int threads = 3, rounds = 2000;
  StepBarrier barrier(threads);
  std::atomic<int> arrived{0};
  std::atomic<bool> early{false};
  {
    std::vector<std::jthread> pool;
    for (int t = 0; t < threads; ++t)
      pool.emplace_back([&, t] {
        for (int round = 0; round < rounds; ++round) {
          if (round % 400 == 0 && t == round / 400 % threads) std::this_thread::sleep_for(std::chrono::milliseconds(1));  // the other threads fall asleep
          ++arrived;
          barrier.arrive_and_wait();
          if (arrived < threads * (round + 1)) early = true;
          barrier.arrive_and_wait();
        }
      });
  }
  EXPECT_FALSE(early);
  EXPECT_EQ(arrived, threads * rounds);
}

}  // namespace
}  // namespace calomel
