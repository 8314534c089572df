#pragma once
/// Samples over time: interpolation, and thinning for the drawings.
#include <cstddef>
#include <span>
#include <vector>

namespace calomel {

/// Values of (times, values) at the times `at` by linear interpolation; NaN outside `times`, which must rise.
std::vector<double> interpolated(std::span<const double> times, std::span<const double> values, std::span<const double> at);

/// A reduction of `n` samples to at most `most`. Each window of equal count keeps its least and its greatest value in their order, so no peak is lost.
class Thinning {
 public:
  Thinning(std::size_t n, std::size_t most);
  [[nodiscard]] std::vector<double> times(std::span<const double> t) const;
  [[nodiscard]] std::vector<double> extremes(std::span<const double> values) const;
  [[nodiscard]] bool active() const { return width_ > 1; }

 private:
  std::size_t n_;
  std::size_t width_ = 1;
};

/// The least step k for which every k-th of `n` items are at most `most` items.
std::size_t stride(std::size_t n, std::size_t most);

}  // namespace calomel
