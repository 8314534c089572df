#include "base/options.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "base/json.hpp"

namespace calomel {

std::string number_text(double x) {
  const std::string brief = fmt::format("{:.6g}", x);
  return std::strtod(brief.c_str(), nullptr) == x || !std::isfinite(x) ? brief : fmt::format("{}", x);
}

std::string Range::text() const {
  const bool has_low = std::isfinite(low), has_high = std::isfinite(high);
  if (has_low && has_high) return fmt::format("{} {} x {} {}", number_text(low), low_open ? "<" : "<=", high_open ? "<" : "<=", number_text(high));
  if (has_low) return fmt::format("{} {}", low_open ? ">" : ">=", number_text(low));
  if (has_high) return fmt::format("{} {}", high_open ? "<" : "<=", number_text(high));
  return "any finite number";
}

void ReferenceVisitor::row(const char* key, const FieldInfo& field, const std::function<void(EchoVisitor&)>& write) {
  Json object = Json::object();
  EchoVisitor echo(object);
  write(echo);
  const Json value = object.contains(key) ? object[key] : Json();
  std::string allowed;
  const bool numbers = value.is_array() && !value.empty() && value[0].is_number();
  if (!field.choices.empty())
    allowed = join(field.choices);
  else if (value.is_number() || value.is_null())
    allowed = field.range.text();
  else if (numbers && (std::isfinite(field.range.low) || std::isfinite(field.range.high)))
    allowed = "each " + field.range.text();
  const std::string text = value.is_number_float() ? number_text(value.get<double>()) : value.dump();
  markdown += fmt::format("| `{}` | {} | {} | {} | {} |\n", prefix_ + key, field.unit,
                          field.required ? "required" : (value.is_null() ? "none" : "`" + text + "`"), allowed, field.doc);
}

void EchoVisitor::operator()(const char* key, const bool& value, const FieldInfo&) { object_[key] = value; }
void EchoVisitor::operator()(const char* key, const int& value, const FieldInfo&) { object_[key] = value; }
void EchoVisitor::operator()(const char* key, const double& value, const FieldInfo&) {
  if (std::isfinite(value)) object_[key] = value;
}
void EchoVisitor::operator()(const char* key, const std::string& value, const FieldInfo&) { object_[key] = value; }
void EchoVisitor::operator()(const char* key, const std::optional<double>& value, const FieldInfo&) {
  if (value) object_[key] = *value;
}
void EchoVisitor::operator()(const char* key, const std::vector<double>& value, const FieldInfo&) { object_[key] = value; }
void EchoVisitor::operator()(const char* key, const std::vector<int>& value, const FieldInfo&) { object_[key] = value; }
void EchoVisitor::operator()(const char* key, const std::vector<std::string>& value, const FieldInfo&) { object_[key] = value; }
Json& EchoVisitor::table(const char* key) {
  object_[key] = Json::object();
  return object_[key];
}

}  // namespace calomel
