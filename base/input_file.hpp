#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "base/errors.hpp"

namespace calomel {

/// The file that the case names at `key`, open for reading. Errors: that of unreadable_file where it cannot be opened or is a directory.
[[nodiscard]] inline std::ifstream input_file(const std::string& key, const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in || std::filesystem::is_directory(path)) throw unreadable_file(key, path);
  return in;
}

}  // namespace calomel
