#pragma once
/// The program as a user calls it.
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace calomel::testing {

struct Outcome {
  int status;
  std::string said;
};

/// `calomel WORDS` in the folder `dir`: its status, and what it said on stderr.
inline Outcome run(const std::filesystem::path& dir, const std::string& words) {
  const std::string command = "cd '" + dir.string() + "' && '" CALOMEL_PROGRAM "' " + words + " 2>&1 >/dev/null";
  std::FILE* pipe = ::popen(command.c_str(), "r");
  Outcome out{-1, ""};
  std::array<char, 4096> buffer;
  for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) out.said.append(buffer.data(), n);
  out.status = WEXITSTATUS(::pclose(pipe));
  return out;
}

/// `text` with the first `old` replaced.
inline std::string with(std::string text, const std::string& old, const std::string& now) {
  EXPECT_NE(text.find(old), std::string::npos) << old;
  text.replace(text.find(old), old.size(), now);
  return text;
}

}  // namespace calomel::testing
