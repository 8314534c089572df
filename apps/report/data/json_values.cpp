#include "apps/report/data/json_values.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace calomel {

std::optional<double> number_at(const Json& json, const std::string& key) {
  const Json& j = part_at(json, key);
  return j.is_number() ? std::optional(j.get<double>()) : std::nullopt;
}

std::string text_at(const Json& json, const std::string& key, const std::string& otherwise) {
  const Json& j = part_at(json, key);
  return j.is_string() ? j.get<std::string>() : otherwise;
}

const Json& list_at(const Json& json, const std::string& key) {
  static const Json nothing = Json::array();
  const Json& j = part_at(json, key);
  return j.is_array() ? j : nothing;
}

const Json& part_at(const Json& json, const std::string& key) {
  static const Json nothing;
  if (!json.is_object()) return nothing;
  const auto found = json.find(key);
  return found == json.end() ? nothing : *found;
}

Json rounded(double x, int digits) {
  if (!std::isfinite(x)) return nullptr;
  const double r = std::strtod(fmt::format("{:.{}e}", x, digits - 1).c_str(), nullptr);
  // Whole numbers are written without ".0".
  if (r == std::trunc(r) && std::abs(r) < 1e15) return Json(std::int64_t(r));
  return r;
}

}  // namespace calomel
