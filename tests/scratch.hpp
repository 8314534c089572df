#pragma once
/// The folder in which the tests of a process write: below gtest's TempDir(), removed when the process ends.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <system_error>

namespace calomel {

class ScratchFolder {
 public:
  ScratchFolder() { std::filesystem::create_directories(path_); }
  ~ScratchFolder() {
    std::error_code none;
    if (::getpid() == owner_) std::filesystem::remove_all(path_, none);  // a forked child leaves it alone
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  pid_t owner_ = ::getpid();
  std::filesystem::path path_ = std::filesystem::path(::testing::TempDir()) / ("calomel_" + std::to_string(owner_));
};

/// A file `name` in the process's folder.
inline std::filesystem::path scratch_file(const std::string& name) {
  static const ScratchFolder folder;
  return folder.path() / name;
}

/// An empty directory `name` in the process's folder.
inline std::filesystem::path scratch(const std::string& name) {
  const auto dir = scratch_file(name);
  std::filesystem::remove_all(dir);
  std::filesystem::create_directories(dir);
  return dir;
}

}  // namespace calomel
