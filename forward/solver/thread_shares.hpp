#pragma once
/// How the blocks of a step are shared among threads, how many threads pay, and how many runs at once.
#include <cstddef>
#include <vector>

namespace calomel {

struct Layout;

/// Contiguous shares of the blocks [begin, end), the greatest of which is as small as can be by `block_cost`: the first of each thread, and the end. Threads
/// may have none. `own_law`: the liquid's is not Riemer's.
std::vector<std::size_t> thread_shares(const Layout& layout, bool own_law, std::size_t begin, std::size_t end, int threads);

/// How many threads a run is given, and how much faster it is estimated to be than on one.
struct ThreadChoice {
  int threads = 1;
  double gain = 1;
};

/// The number of threads, at most `most`, on which a step is estimated to end first: the greatest share of blocks that a thread has, in the cost of
/// `block_cost` times `lanes` (what an element of eight runs costs beside one of a single run), and `meeting_cost` where threads meet. Slow blocks count once
/// in `subcycles` steps. Numbers of threads that would be at work less than `least_efficiency` of their time are left out.
ThreadChoice useful_threads(const Layout& layout, bool own_law, double lanes, int subcycles, int most);

/// What the meetings of a step cost on two or more threads, in general elements of liquid (1 of `block_cost`): about 5 us, see docs/benchmarks/solver_speed.md.
inline constexpr double meeting_cost = 250;
inline constexpr double least_efficiency = 0.6;
/// What an element of eight runs in the lanes costs beside one of a single run.
inline constexpr double group_cost = 3.5;

/// How many runs are computed at once where `left` are to be done: as many as there are, eight at most. Two or three of a solid mesh are computed one by one,
/// which costs less than the lanes of eight; in plane strain lanes cost about one run.
std::size_t runs_at_once(std::size_t left, bool plane_strain);

}  // namespace calomel
