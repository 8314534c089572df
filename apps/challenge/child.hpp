#pragma once
/// Other programs, called one at a time; and one call at a time at work on a suite.
#include <filesystem>
#include <span>
#include <string>

namespace calomel::challenge {

/// Runs `program` with these words, stdout and stderr to the file `log`, and waits for it. Its exit status; 128 plus the signal that ended it; 127 when it
/// cannot be started. It never outlives this program. Errors: Interrupted when the user requested a stop; the program has then received SIGTERM and has ended.
/// InputError when `log` cannot be written.
int run_child(const std::filesystem::path& program, std::span<const std::string> words, const std::filesystem::path& log);

/// The last line of a file that is neither empty nor indented; empty when there is none.
std::string last_line(const std::filesystem::path& file);

/// This program's own file.
std::filesystem::path own_program();

/// Keeps a second call that does the same off a suite while it lives.
class SuiteLock {
 public:
  /// Makes the directory. `what` is done there, a word. Errors: InputError when another calomel is at it, or the directory cannot be written.
  SuiteLock(const std::filesystem::path& directory, const std::string& what);
  ~SuiteLock();
  SuiteLock(const SuiteLock&) = delete;
  SuiteLock& operator=(const SuiteLock&) = delete;

 private:
  int file_ = -1;
};

}  // namespace calomel::challenge
