#pragma once
/// The program as a user calls it.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
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

/// The same: its status, and what it wrote to stdout.
inline Outcome printed(const std::filesystem::path& dir, const std::string& words) {
  const auto file = dir / "stdout.txt";
  const std::string command = "cd '" + dir.string() + "' && '" CALOMEL_PROGRAM "' " + words + " >'" + file.string() + "' 2>/dev/null";
  const int status = std::system(command.c_str());
  std::ifstream in(file, std::ios::binary);
  return {WEXITSTATUS(status), {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()}};
}

/// The program as a child in the folder `dir`, with these words.
inline pid_t start_program(const std::filesystem::path& dir, const std::vector<std::string>& words) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::vector<char*> argv{const_cast<char*>(CALOMEL_PROGRAM)};
    for (const auto& w : words) argv.push_back(const_cast<char*>(w.c_str()));
    argv.push_back(nullptr);
    if (::chdir(dir.c_str()) == 0) ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  return child;
}

/// Waits until `seen()` has returned true the given number of times, or the child has ended, then sends the signal. Returns how the child ended, or -1 if it
/// ended by itself.
template <class Seen>
inline int stop_program(pid_t child, int signal, int times, Seen&& seen) {
  int status = 0;
  while (times > 0) {
    if (::waitpid(child, &status, WNOHANG) == child) return -1;
    times -= seen();
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  ::kill(child, signal);
  ::waitpid(child, &status, 0);
  return status;
}

/// `text` with the first `old` replaced.
inline std::string with(std::string text, const std::string& old, const std::string& now) {
  EXPECT_NE(text.find(old), std::string::npos) << old;
  text.replace(text.find(old), old.size(), now);
  return text;
}

}  // namespace calomel::testing
