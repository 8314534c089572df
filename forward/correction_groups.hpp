#pragma once
/// The terms and places by which a diagnosis describes what is missing.
#include <string>

#include "forward/parameter_group.hpp"

namespace calomel {

/// A number of `correction_1` as one of correction_N, so that several act in one run.
[[nodiscard]] inline AddedParameter as_correction(AddedParameter number, std::size_t n) {
  const std::string first = "correction_1";
  const auto renamed = [&](std::string& key) { key.replace(key.find(first), first.size(), "correction_" + std::to_string(n)); };
  renamed(number.parameter.key), renamed(number.parameter.name);
  for (auto& [key, value] : number.with) renamed(key);
  return number;
}

/// Each term at each place as a group of one number. The mercury as a whole and, of a box, in thirds of its length and along each wall; each wall there is and, of a box, its quarters.
[[nodiscard]] std::vector<ParameterGroup> correction_groups(const ForwardCase& forward_case);

}  // namespace calomel
