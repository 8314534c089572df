#pragma once
/// One call at a time in a directory of artefacts.
#include <filesystem>

namespace calomel {

/// Holds the directory for the life of the object and no longer than the process lives (flock; nothing is written). Where the file system has no such locks
/// nothing is held.
class DirectoryLock {
 public:
  /// Errors: InputError where another process holds it.
  explicit DirectoryLock(const std::filesystem::path& directory);
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  int file_ = -1;
};

}  // namespace calomel
