#pragma once
/// Options: plain structs with defaults and one `visit(v)` that names every field. The visitors here and in
/// case_file.hpp read, validate, echo, set and document them; nothing else lists the keys again.
///
///   struct TimeOptions {
///     double end = 1e-3;
///     template <class V> void visit(V& v) { v("end", end, {.unit = "s", .range = above(0), .doc = "end of the record"}); }
///   };
///
/// Fields may be bool, int, double, std::string, std::optional<double>, std::array<double, N>,
/// std::vector<double>, std::vector<int>, std::vector<std::string>; a nested Options joins through
/// `v.table("profile", profile, "doc")`. A key that is no longer read is declared by `v.renamed("old", "new = 1 | 2 says it now")`: a case that has it is
/// refused with those words. Optional members: `validate() const` throws InputError for what spans fields.
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "base/errors.hpp"

namespace calomel {

using Json = nlohmann::ordered_json;  ///< by name only; json.hpp defines it

/// Allowed interval of a number, both ends closed unless stated.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;
  bool high_open = false;
  [[nodiscard]] bool contains(double x) const { return (low_open ? x > low : x >= low) && (high_open ? x < high : x <= high); }
  [[nodiscard]] std::string text() const;
};
inline Range any() { return {}; }
inline Range at_least(double low) { return {.low = low}; }
inline Range above(double low) { return {.low = low, .low_open = true}; }
inline Range between(double low, double high) { return {.low = low, .high = high}; }
inline Range strictly_between(double low, double high) { return {.low = low, .high = high, .low_open = true, .high_open = true}; }

/// 17 digits where needed, fewer if they give the same value.
std::string number_text(double x);

/// A table that holds no keys, only tables if any.
struct NoKeys {
  template <class V>
  void visit(V&) {}
};

/// What a field is, beside its key and value.
struct FieldInfo {
  std::string unit;                  ///< SI; empty for a pure number
  Range range;                       ///< numbers (each element of a list)
  std::string doc;                   ///< one line
  bool required = false;             ///< no silent default
  std::vector<std::string> choices;  ///< words
  std::size_t least_size = 0;        ///< lists
};

/// Writes Options into a JSON object, in the order of the fields: the echo that every artefact carries (`echo` in json.hpp). A number that is absent or not
/// finite is left out.
class EchoVisitor {
 public:
  /// `object` outlives the visitor.
  explicit EchoVisitor(Json& object) : object_(object) {}
  void operator()(const char* key, const bool& value, const FieldInfo&);
  void operator()(const char* key, const int& value, const FieldInfo&);
  void operator()(const char* key, const double& value, const FieldInfo&);
  void operator()(const char* key, const std::string& value, const FieldInfo&);
  void operator()(const char* key, const std::optional<double>& value, const FieldInfo&);
  void operator()(const char* key, const std::vector<double>& value, const FieldInfo&);
  void operator()(const char* key, const std::vector<int>& value, const FieldInfo&);
  void operator()(const char* key, const std::vector<std::string>& value, const FieldInfo&);
  template <std::size_t N>
  void operator()(const char* key, const std::array<double, N>& value, const FieldInfo& info) {
    (*this)(key, std::vector<double>(value.begin(), value.end()), info);
  }
  template <class O>
  void table(const char* key, O& options, const char*) {
    EchoVisitor inner(table(key));
    options.visit(inner);
  }
  void renamed(const char*, const char*) {}

 private:
  /// The new empty object at the key.
  Json& table(const char* key);
  Json& object_;
};

/// Finds the number at a dotted path ("profile.decay", "center.1") so that a parameter can be bound to any number of a case.
class NumberVisitor {
 public:
  explicit NumberVisitor(std::string path) : path_(std::move(path)) {}
  double* number = nullptr;                   ///< set when the path names a double
  std::optional<double>* optional = nullptr;  ///< set when it names an optional double
  FieldInfo info;
  std::vector<std::string> known;  ///< every path that names a number

  template <class T>
  void operator()(const char* key, T& value, const FieldInfo& field) {
    const std::string full = prefix_ + key;
    if constexpr (std::is_same_v<T, double>) {
      known.push_back(full);
      if (full == path_) {
        number = &value;
        info = field;
      }
    } else if constexpr (std::is_same_v<T, std::optional<double>>) {
      known.push_back(full);
      if (full == path_) {
        optional = &value;
        info = field;
      }
    } else if constexpr (requires {
                           value.size();
                           requires std::is_same_v < std::decay_t<decltype(value[0])>,
                           double > ;
                         }) {
      for (std::size_t i = 0; i < value.size(); ++i) {
        known.push_back(full + '.' + std::to_string(i));
        if (known.back() == path_) {
          number = &value[i];
          info = field;
        }
      }
    }
  }
  template <class O>
  void table(const char* key, O& options, const char*) {
    const std::string outer = prefix_;
    prefix_ += std::string(key) + '.';
    options.visit(*this);
    prefix_ = outer;
  }
  void renamed(const char*, const char*) {}

 private:
  std::string path_, prefix_;
};

/// Rows of the generated case reference: key, type, unit, default, range, doc.
class ReferenceVisitor {
 public:
  explicit ReferenceVisitor(std::string prefix) : prefix_(std::move(prefix)) {}
  std::string markdown;
  template <class T>
  void operator()(const char* key, T& value, const FieldInfo& field) {
    row(key, field, [&](EchoVisitor& echo) { echo(key, value, field); });
  }
  template <class O>
  void table(const char* key, O& options, const char*) {
    ReferenceVisitor inner(prefix_ + key + '.');
    options.visit(inner);
    markdown += inner.markdown;
  }
  void renamed(const char*, const char*) {}

 private:
  /// `write` echoes the default.
  void row(const char* key, const FieldInfo& field, const std::function<void(EchoVisitor&)>& write);
  std::string prefix_;
};

}  // namespace calomel
