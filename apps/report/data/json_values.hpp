#pragma once
/// Values of JSON objects that may lack them, and numbers of JSON with few digits.
#include <optional>
#include <string>

#include "base/json.hpp"

namespace calomel {

/// The number at `key`, when `json` is an object that has one.
std::optional<double> number_at(const Json& json, const std::string& key);
/// The text at `key`, or `otherwise`.
std::string text_at(const Json& json, const std::string& key, const std::string& otherwise = "");
/// The list at `key`, or an empty one.
const Json& list_at(const Json& json, const std::string& key);
/// The value at `key`, or null.
const Json& part_at(const Json& json, const std::string& key);

/// `x` rounded to `digits` significant digits, so that its shortest text has no more digits. Null when `x` is not finite.
Json rounded(double x, int digits);

}  // namespace calomel
