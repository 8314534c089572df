#pragma once
/// Reference data that lie beside the source tree, and the message of a test that is skipped because they are absent.
#include <cstdlib>
#include <filesystem>
#include <string>

namespace calomel::testing {

/// The folder `shared` beside the source tree `source`, or the one that the environment's CALOMEL_SHARED names.
inline std::filesystem::path shared_folder(const char* source) {
  if (const char* named = std::getenv("CALOMEL_SHARED")) return named;
  return std::filesystem::path(source).parent_path() / "shared";
}

/// The reason for which a test is skipped that needs `file` of that folder. `.ci/run` looks for these words.
inline std::string absent_from_shared(const std::filesystem::path& file) { return "absent from ../shared: " + file.string(); }

}  // namespace calomel::testing
