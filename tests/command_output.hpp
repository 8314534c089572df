#pragma once
/// What another program says to a test.
#include <cstdio>
#include <string>
#include <utility>

namespace calomel::testing {

/// Output of a command, both streams, and whether it ended well.
inline std::pair<std::string, bool> output_of(const std::string& command) {
  std::string text;
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (!pipe) return {"", false};
  char part[4096];
  for (std::size_t n; (n = std::fread(part, 1, sizeof part, pipe)) > 0;) text.append(part, n);
  return {text, ::pclose(pipe) == 0};
}

}  // namespace calomel::testing
