#pragma once
/// Names, units and numbers of a diagnosis as a person would write them; diagnosis_words makes sentences of them.
#include <map>
#include <span>
#include <string>
#include <vector>

#include "uq/diagnosis/alternative.hpp"
#include "uq/diagnosis/missing_terms.hpp"

namespace calomel {

constexpr double least_support = 3;  ///< log Bayes factor up to which the records do not support an explanation

/// The text with a capital, and as a sentence with a full stop.
[[nodiscard]] std::string capital(std::string text);
[[nodiscard]] std::string sentence(const std::string& text);

/// "a", "a and b", "a, b and c".
[[nodiscard]] std::string listed(const std::vector<std::string>& words, const char* last = "and");

/// The group of this name, or null.
[[nodiscard]] const ParameterGroup* group_of(std::span<const ParameterGroup> groups, const std::string& name);

/// The unit in which a number of this size is shown, and the factor that converts to it.
struct ShownUnit {
  double factor;
  std::string name;
};
[[nodiscard]] ShownUnit shown_unit(const std::string& unit, double greatest);

/// "12 %", with one decimal below 10 %.
[[nodiscard]] std::string percent(double share);

/// "2.31 ± 0.16 mm": the sd with two significant digits and the value with as many decimals.
[[nodiscard]] std::string with_sd(double value, double sd, const std::string& unit);

/// "120 µs", "7.5 ms", "12 s".
[[nodiscard]] std::string time_text(double seconds);

/// A mechanism, or a pair of them, by its plain name: "the proton beam's profile". A mechanism without a plain name keeps its own.
[[nodiscard]] std::string plain_name(const Alternative& a, std::span<const ParameterGroup> groups);

/// One of an alternative's numbers.
struct PlainNumber {
  std::string value;  ///< "2.31 ± 0.16 mm"
  std::string off;    ///< its value where the mechanism is left out, "0 mm"
};
[[nodiscard]] PlainNumber plain_number(const Alternative& a, const Estimate& number, std::span<const ParameterGroup> groups);
/// The two numbers that lie farthest from off in their standard deviations: "offset_z 2.31 ± 0.16 mm in place of 0 mm". Empty where there is none.
[[nodiscard]] std::string plain_size(const Alternative& a, std::span<const ParameterGroup> groups);

/// The places of an alternative by group, walls with the stretch that was fitted: "front, 10.3 to 25.5 mm".
[[nodiscard]] std::map<std::string, std::string> fitted_places(const Alternative& a);
/// The place of one mechanism; the place itself where the numbers have no ends of a stretch.
[[nodiscard]] std::string fitted_place(const std::string& mechanism, const std::string& place, const std::vector<Estimate>& numbers);

/// The change that a term represents, "+12 ± 2 kg/m²"; a share in percent.
[[nodiscard]] std::string plain_term(const MissingTerm& term);

}  // namespace calomel
