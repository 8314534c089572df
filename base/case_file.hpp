#pragma once
/// The case file: TOML with line numbers, `--set` overrides, and typed reading of Options with errors a stranger can act on.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/options.hpp"

namespace toml {
inline namespace v3 {
class table;
class node;
}  // namespace v3
}  // namespace toml

namespace calomel {

class CaseFile {
 public:
  /// Parses `path` and applies `overrides` ("table.key=value", the value in TOML or a bare word).
  /// Errors: InputError when the file is absent or not TOML, or an override is malformed.
  explicit CaseFile(std::filesystem::path path, std::span<const std::string> overrides = {});
  /// The same from text, for tests.
  static CaseFile from_text(const std::string& text, const std::string& name = "case.toml");
  ~CaseFile();
  CaseFile(CaseFile&&) noexcept;
  CaseFile& operator=(CaseFile&&) noexcept;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Relative paths in a case start at the case file.
  [[nodiscard]] std::filesystem::path resolve(const std::string& relative) const;

  /// Whether there is a value or table at the dotted path ("recordings", "sensor[0].gauge_length").
  [[nodiscard]] bool has(const std::string& path) const;
  /// Names of the tables under `path`, in file order (toml++ itself iterates alphabetically).
  [[nodiscard]] std::vector<std::string> names(const std::string& path) const;
  /// Number of tables in the array at `path` ("sensor").
  [[nodiscard]] std::size_t count(const std::string& path) const;
  /// The text at `path`, when it is a string.
  [[nodiscard]] std::optional<std::string> text(const std::string& path) const;
  /// The number at `path`, when it is one.
  [[nodiscard]] std::optional<double> number(const std::string& path) const;
  /// The value at `path`, or an empty object.
  [[nodiscard]] Json json(const std::string& path) const;
  /// Accepts `path` (a key or table read by other means than `read`).
  void accept(const std::string& path);

  /// Reads the table at `path` into `options`: types, ranges, choices and required keys are checked, an unknown key
  /// is an error that names the nearest known one, then `options.validate()` where it exists.
  /// A table that is absent leaves the defaults (but required keys must be there when `required_table`).
  /// `extra` keys are allowed and left to the caller.
  template <class O>
  void read(const std::string& path, O& options, std::span<const std::string> extra = {});

  /// Errors: InputError for the first top-level table that nobody read, naming the nearest known.
  void expect_all_read(std::span<const std::string> known_tables) const;

  /// The error with file, line, column and value filled in from its key.
  [[nodiscard]] InputError located(const InputError& error) const;
  /// Runs `body`; an InputError without a place leaves it with one.
  template <class F>
  auto locating(F&& body) const {
    try {
      return body();
    } catch (const InputError& e) {
      throw located(e);
    }
  }

  class Reader;

 private:
  CaseFile() = default;
  struct Document;
  std::filesystem::path path_;
  std::unique_ptr<Document> document_;
};

/// The reading visitor; one per table.
class CaseFile::Reader {
 public:
  Reader(CaseFile& file, std::string path);
  ~Reader();

  void operator()(const char* key, bool& value, const FieldInfo& info);
  void operator()(const char* key, int& value, const FieldInfo& info);
  void operator()(const char* key, double& value, const FieldInfo& info);
  void operator()(const char* key, std::string& value, const FieldInfo& info);
  void operator()(const char* key, std::optional<double>& value, const FieldInfo& info);
  void operator()(const char* key, std::vector<double>& value, const FieldInfo& info);
  void operator()(const char* key, std::vector<int>& value, const FieldInfo& info);
  void operator()(const char* key, std::vector<std::string>& value, const FieldInfo& info);
  template <std::size_t N>
  void operator()(const char* key, std::array<double, N>& value, const FieldInfo& info) {
    std::vector<double> list(value.begin(), value.end());
    FieldInfo sized = info;
    sized.least_size = N;
    (*this)(key, list, sized);
    if (list.size() != N) fail_size(key, N, list.size());
    std::copy(list.begin(), list.end(), value.begin());
  }
  template <class O>
  void table(const char* key, O& options, const char*) {
    known_.push_back(key);
    file_.read(path_.empty() ? std::string(key) : path_ + '.' + key, options);
  }
  /// Errors: InputError, saying "take it out: " and `instead`, when the table has the key.
  void renamed(const char* key, const char* instead);
  /// Errors: InputError for the first key of the table that no field and no `extra` claimed.
  void finish(std::span<const std::string> extra);

 private:
  const toml::node* find(const char* key, const FieldInfo& info);
  double number(const toml::node& node, const std::string& key, const FieldInfo& info);
  [[noreturn]] void fail(const toml::node& node, const std::string& key, const std::string& expected, const FieldInfo& info);
  [[noreturn]] void fail_size(const char* key, std::size_t wanted, std::size_t got);
  CaseFile& file_;
  std::string path_;
  const toml::table* table_ = nullptr;
  std::vector<std::string> known_;
};

template <class O>
void CaseFile::read(const std::string& path, O& options, std::span<const std::string> extra) {
  Reader reader(*this, path);
  options.visit(reader);
  reader.finish(extra);
  if constexpr (requires { options.validate(); }) try {
      options.validate();
    } catch (const InputError& e) {
      auto parts = e.parts();
      if (!parts.key.empty() && !path.empty() && parts.file.empty()) parts.key = path + '.' + parts.key;
      throw located(InputError(parts));
    }
}

}  // namespace calomel
