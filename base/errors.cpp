#include "base/errors.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace calomel {
namespace {

std::string text(const InputError::Parts& p) {
  std::string s;
  if (!p.file.empty()) {
    s += p.file;
    if (p.line > 0) s += ':' + std::to_string(p.line);
    if (p.line > 0 && p.column > 0) s += ':' + std::to_string(p.column);
    s += ": ";
  }
  if (!p.key.empty())
    s += p.key + (p.value.empty() ? "" : " = " + p.value) + ": ";
  else if (!p.value.empty())
    s += p.value + ": ";
  s += p.problem;
  if (!p.range.empty()) s += " (allowed: " + p.range + ")";
  if (!p.suggestion.empty()) s += "; " + p.suggestion;
  return s;
}

}  // namespace

InputError::InputError(Parts parts) : std::runtime_error(text(parts)), parts_(std::move(parts)) {}

void fail_contract(const char* what, const char* file, int line) { throw ContractFailure(std::string(file) + ':' + std::to_string(line) + ": " + what); }

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, previous(b.size() + 1), current(b.size() + 1);
  std::iota(previous.begin(), previous.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    current[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      current[j] = std::min({previous[j] + 1, current[j - 1] + 1, previous[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) current[j] = std::min(current[j], before[j - 2] + 1);
    }
    before = previous;
    std::swap(previous, current);
  }
  return previous[b.size()];
}

namespace {

/// Edit distance to a known name; a name that begins it is one edit away.
std::size_t distance_to(std::string_view name, std::string_view known) {
  return name.size() > 2 && name != known && known.starts_with(name) ? 1 : edit_distance(name, known);
}

}  // namespace

std::string nearest_name(std::string_view name, std::span<const std::string> known) {
  std::string best;
  std::size_t distance = std::string_view::npos;
  for (const auto& k : known)
    if (const auto d = distance_to(name, k); d < distance) distance = d, best = k;
  return best;
}

std::string name_suggestion(std::string_view name, std::span<const std::string> known) {
  const std::string near = nearest_name(name, known);
  return near.empty() || 2 * distance_to(name, near) > std::max(name.size(), near.size()) ? "" : "did you mean \"" + near + "\"?";
}

InputError unreadable_file(std::string key, const std::filesystem::path& path) {
  std::vector<std::string> there;
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    return InputError(
        {.problem = "this is a directory, not a file", .key = std::move(key), .value = '"' + path.string() + '"', .suggestion = "name the file in it"});
  for (const auto& entry : std::filesystem::directory_iterator(path.has_parent_path() ? path.parent_path() : ".", ignored))
    there.push_back(entry.path().filename().string());
  std::sort(there.begin(), there.end());
  const std::string near = name_suggestion(path.filename().string(), there);
  return InputError({.problem = "the file cannot be opened",
                     .key = std::move(key),
                     .value = '"' + path.string() + '"',
                     .suggestion = (near.empty() ? "check the name;" : near) + " relative paths start at the case file"});
}

std::string join(std::span<const std::string> words, std::string_view between) {
  std::string s;
  for (const auto& w : words) s += (s.empty() ? "" : std::string(between)) + w;
  return s;
}

}  // namespace calomel
