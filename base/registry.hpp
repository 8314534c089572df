#pragma once
/// A catalogue from names to factories. Each folder with a catalogue fills one in its `register.cpp`.
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/errors.hpp"

namespace calomel {

template <class Entry>
class Registry {
 public:
  struct Row {
    std::string name;
    std::string summary;  ///< one line for `calomel list` and the reference page
    Entry entry;
  };

  /// `what` names the kind of thing in messages, e.g. "optimiser".
  explicit Registry(std::string what) : what_(std::move(what)) {}

  Registry& add(std::string name, std::string summary, Entry entry) {
    rows_.push_back({std::move(name), std::move(summary), std::move(entry)});
    return *this;
  }
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  [[nodiscard]] const std::string& what() const { return what_; }

  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& r : rows_) all.push_back(r.name);
    return all;
  }
  [[nodiscard]] bool contains(std::string_view name) const {
    for (const auto& r : rows_)
      if (r.name == name) return true;
    return false;
  }
  /// The entry called `name`. `key` is the case-file key it came from.
  /// Errors: InputError that lists the known names and suggests the nearest.
  [[nodiscard]] const Entry& get(std::string_view name, std::string_view key = "") const {
    for (const auto& r : rows_)
      if (r.name == name) return r.entry;
    const auto known = names();
    throw InputError({.problem = "no " + what_ + " of this name",
                      .key = std::string(key),
                      .value = '"' + std::string(name) + '"',
                      .range = join(known),
                      .suggestion = name_suggestion(name, known)});
  }

 private:
  std::string what_;
  std::vector<Row> rows_;
};

}  // namespace calomel
