#pragma once
/// Random streams that depend on (seed, index) alone, so that results do not depend on the number of threads
/// or on the order of runs. The engine (mt19937_64) and its seeding are fixed by the C++ standard.
#include <boost/random/normal_distribution.hpp>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace calomel {

class RandomStream {
 public:
  using result_type = std::mt19937_64::result_type;

  RandomStream(std::uint64_t seed, std::uint64_t index) {
    std::seed_seq words{std::uint32_t(seed), std::uint32_t(seed >> 32), std::uint32_t(index), std::uint32_t(index >> 32), 0xca10u};
    engine_.seed(words);
  }
  static constexpr result_type min() { return std::mt19937_64::min(); }
  static constexpr result_type max() { return std::mt19937_64::max(); }
  result_type operator()() { return engine_(); }

  /// Uniform on [0, 1), 53 random bits.
  double uniform() { return double(engine_() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double normal() { return normal_(engine_); }
  /// Uniform on {0, ..., n-1}, n > 0 (rejection, no bias).
  std::uint64_t below(std::uint64_t n) {
    const std::uint64_t limit = max() - max() % n;
    std::uint64_t x = engine_();
    while (x >= limit) x = engine_();
    return x % n;
  }
  /// A random permutation of 0..n-1 (Fisher and Yates).
  std::vector<std::size_t> permutation(std::size_t n) {
    std::vector<std::size_t> p(n);
    for (std::size_t i = 0; i < n; ++i) p[i] = i;
    for (std::size_t i = n; i > 1; --i) std::swap(p[i - 1], p[below(i)]);
    return p;
  }

 private:
  std::mt19937_64 engine_;
  boost::random::normal_distribution<double> normal_;
};

}  // namespace calomel
