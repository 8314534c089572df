#pragma once
/// Errors of three kinds: the user's (InputError), the numerics' (NumericsError) and our own (contract failures).
#include <algorithm>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace calomel {

/// Exit statuses of the program; outside tools rely on them.
enum class ExitStatus : int { done = 0, bad_input = 2, failed_numerics = 3, not_to_be_trusted = 4, interrupted = 130 };

/// A mistake in what the user gave. Every part that is known is filled; `what()` reads
/// `FILE:LINE:COL: key = value: problem (allowed: range); suggestion`.
class InputError : public std::runtime_error {
 public:
  struct Parts {
    std::string problem;     ///< what is wrong and why, a clause
    std::string key;         ///< dotted path in the case file, e.g. "geometry.walls.top", "sensor[1].position"
    std::string value;       ///< the offending value as given
    std::string range;       ///< what would be allowed
    std::string suggestion;  ///< what to do next
    std::string file;        ///< the file's path
    int line = 0;            ///< counted from 1; 0 = not known
    int column = 0;          ///< counted from 1; 0 = not known
  };

  explicit InputError(Parts parts) : std::runtime_error(text(parts)), parts_(std::move(parts)) {}
  [[nodiscard]] const Parts& parts() const { return parts_; }

 private:
  static std::string text(const Parts& p) {
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
  Parts parts_;
};

/// The computation itself failed: a collapsed step, a NaN, a model outside that does not answer.
class NumericsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The user stopped the program; what was finished is on disk and a second call resumes.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted; run the same command again to resume") {}
};

/// A promise between our own functions was broken: a defect of the program, never of the user.
class ContractFailure : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Throws ContractFailure with the caller's place in the source when `holds` is false. (Builtins, because clang 14 has no std::source_location.)
inline void expect(bool holds, const char* what, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  if (!holds) throw ContractFailure(std::string(file) + ':' + std::to_string(line) + ": " + what);
}

/// Edit distance of two names (Levenshtein 1966), a neighbouring swap counting as one edit.
inline std::size_t edit_distance(std::string_view a, std::string_view b) {
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

/// The known name nearest to `name`; empty when there is none at all.
inline std::string nearest_name(std::string_view name, std::span<const std::string> known) {
  std::string best;
  std::size_t distance = std::string_view::npos;
  for (const auto& k : known)
    if (const auto d = edit_distance(name, k); d < distance) distance = d, best = k;
  return best;
}

/// "a, b, c"
inline std::string join(std::span<const std::string> words, std::string_view between = ", ") {
  std::string s;
  for (const auto& w : words) s += (s.empty() ? "" : std::string(between)) + w;
  return s;
}

}  // namespace calomel
