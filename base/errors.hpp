#pragma once
/// Errors of three kinds: the user's (InputError), the numerics' (NumericsError) and our own (contract failures).
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

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

  explicit InputError(Parts parts);
  [[nodiscard]] const Parts& parts() const { return parts_; }

 private:
  Parts parts_;
};

/// The computation itself failed: a collapsed step, a NaN, an external model that does not answer.
class NumericsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An external model does not answer at all. No run is recorded as failed, since none is at fault.
class Unreachable : public NumericsError {
 public:
  using NumericsError::NumericsError;
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

[[noreturn]] void fail_contract(const char* what, const char* file, int line);

/// Throws ContractFailure with the caller's place in the source when `holds` is false. (Builtins, because clang 14 has no std::source_location.)
inline void expect(bool holds, const char* what, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  if (!holds) fail_contract(what, file, line);
}

/// Edit distance of two names (Levenshtein 1966), a neighbouring swap counting as one edit.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The known name nearest to `name`, one that it begins counting as one edit away; empty when there is none at all.
std::string nearest_name(std::string_view name, std::span<const std::string> known);

/// `did you mean "NAME"?` with the known name nearest to `name`, where no more than half of its letters differ, else nothing.
std::string name_suggestion(std::string_view name, std::span<const std::string> known);

/// The error of a file that the case names at `key` and that cannot be read; it suggests the nearest name in its folder.
InputError unreadable_file(std::string key, const std::filesystem::path& path);

/// "a, b, c"
std::string join(std::span<const std::string> words, std::string_view between = ", ");

}  // namespace calomel
