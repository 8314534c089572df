#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

namespace calomel {
/// An empty directory for one test.
inline std::filesystem::path scratch(const std::string& name) {
  const auto dir = std::filesystem::path(testing::TempDir()) / ("calomel_inverse_" + name + "_" + std::to_string(::getpid()));
  std::filesystem::remove_all(dir);
  std::filesystem::create_directories(dir);
  return dir;
}
}  // namespace calomel
