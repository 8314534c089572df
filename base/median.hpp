#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/errors.hpp"

namespace calomel {

/// The upper median of n > 0 values, which is one of them: entry n / 2 of the sorted list, counted from 0. O(n).
[[nodiscard]] inline double upper_median(std::vector<double> values) {
  expect(!values.empty(), "a list with a median holds something");
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace calomel
