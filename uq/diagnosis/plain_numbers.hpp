#pragma once
/// Names, units and numbers of a diagnosis as a person would write them; plain_words makes sentences of them.
#include <span>
#include <string>
#include <vector>

#include "uq/diagnosis/diagnosis.hpp"

namespace calomel {

/// "a", "a and b", "a, b and c".
[[nodiscard]] std::string listed(const std::vector<std::string>& words, const char* last = "and");

/// The group of this name, or null.
[[nodiscard]] const ParameterGroup* group_of(std::span<const ParameterGroup> groups, const std::string& name);

/// The unit that a number of this size is shown in, and what it is multiplied with for it.
struct ShownUnit {
  double factor;
  std::string name;
};
[[nodiscard]] ShownUnit shown_unit(const std::string& unit, double greatest);

/// "2.31 ± 0.16 mm": the sd with two significant digits and the value with as many decimals.
[[nodiscard]] std::string with_sd(double value, double sd, const std::string& unit);

/// "120 µs", "7.5 ms", "12 s".
[[nodiscard]] std::string time_text(double seconds);

/// A mechanism, or a pair of them, by its plain name: "the proton beam's profile". One without a plain name keeps its own.
[[nodiscard]] std::string plain_name(const Alternative& a, std::span<const ParameterGroup> groups);

/// One of an alternative's numbers.
struct PlainNumber {
  std::string value;      ///< "2.31 ± 0.16 mm"
  std::string off;        ///< what it is where the mechanism is left out, "0 mm"
  std::string doc;        ///< "of the axis, upwards"
  double deviations = 0;  ///< from off, in its sd
};
[[nodiscard]] PlainNumber plain_number(const Alternative& a, const Estimate& number, std::span<const ParameterGroup> groups);
/// The two numbers that stand farthest from off in their deviations: "offset_z 2.31 ± 0.16 mm in place of 0 mm". Empty where it has none.
[[nodiscard]] std::string plain_size(const Alternative& a, std::span<const ParameterGroup> groups);

/// The wall of a place with the stretch that was fitted, "front, 10.3 to 25.5 mm"; the place itself where the numbers have no ends.
[[nodiscard]] std::string fitted_place(const std::string& mechanism, const std::string& place, const std::vector<Estimate>& numbers);

}  // namespace calomel
