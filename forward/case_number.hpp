#pragma once
/// A number of a case, found by its dotted key.
#include <optional>
#include <string>
#include <type_traits>

#include "base/errors.hpp"
#include "base/options.hpp"
#include "forward/parameter.hpp"

namespace calomel {

/// One that is always there, or an optional one. Of a case that may not be changed, one that may not.
template <class Case>
struct FoundNumber {
  std::conditional_t<std::is_const_v<Case>, const double, double>* number = nullptr;
  std::conditional_t<std::is_const_v<Case>, const std::optional<double>, std::optional<double>>* optional = nullptr;
  FieldInfo info = {};  ///< its unit, and the range that the case may set it to

  /// Errors: InputError where an optional one is not set.
  [[nodiscard]] double value(const std::string& key) const {
    if (number) return *number;
    if (!*optional)
      throw InputError({.problem = "has no value in the case, so there is no nominal",
                        .value = '"' + key + '"',
                        .suggestion = "set it in its table, or give the parameter a nominal"});
    return **optional;
  }
  void set(double value) const {
    if (number)
      *number = value;
    else
      *optional = value;
  }
};

/// Gives the parameter the unit of its number, and holds its bounds against the range that the number's key has. Errors: InputError at the bound's place.
inline void take_over(const CaseFile& file, Parameter& p, const FieldInfo& info) {
  p.unit = info.unit;
  const Range range = between(info.range.low, info.range.high);  // a bound may lie on an end that a value may not
  for (const auto& [word, bound] : {std::pair{"min", p.min}, {"max", p.max}})
    if (!range.contains(bound))
      throw file.located(InputError({.problem = p.key + " cannot be that",
                                     .key = "parameter." + p.name + '.' + word,
                                     .value = number_text(bound) + (p.unit.empty() ? "" : ' ' + p.unit),
                                     .range = info.range.text()}));
}

}  // namespace calomel
