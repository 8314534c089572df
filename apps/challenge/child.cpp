#include "apps/challenge/child.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <system_error>
#include <thread>
#include <vector>

#include "apps/interrupt.hpp"
#include "base/artefact.hpp"
#include "base/errors.hpp"

namespace calomel::challenge {

namespace {

InputError unwritable(const std::filesystem::path& path) {
  return InputError({.problem = "cannot be written", .suggestion = "check the free space and the rights", .file = path.string()});
}

}  // namespace

int run_child(const std::filesystem::path& program, std::span<const std::string> words, const std::filesystem::path& log) {
  const int out = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (out < 0) throw unwritable(log);
  std::string first = program.string();  // all memory is taken before the fork
  std::vector<std::string> copies(words.begin(), words.end());
  std::vector<char*> argv{first.data()};
  for (auto& w : copies) argv.push_back(w.data());
  argv.push_back(nullptr);
  const pid_t parent = ::getpid(), child = ::fork();
  if (child == 0) {
    ::setpgid(0, 0);  // Ctrl-C comes to it through this program, once
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() == parent && ::dup2(out, STDOUT_FILENO) >= 0 && ::dup2(out, STDERR_FILENO) >= 0) ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  ::close(out);
  if (child < 0) throw NumericsError("no further process can be started: " + std::generic_category().message(errno));
  int status = 0;
  bool terminated = false;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (stop_requested() && !terminated) ::kill(child, SIGTERM), terminated = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  if (stop_requested()) throw Interrupted();
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string last_line(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string last;
  for (std::string line; std::getline(in, line);)
    if (!line.empty() && line[0] != ' ') last = line;  // what is indented shows where, below what
  return last;
}

std::filesystem::path own_program() {
  std::error_code none;
  return std::filesystem::read_symlink("/proc/self/exe", none);
}

SuiteLock::SuiteLock(const std::filesystem::path& directory, const std::string& what) {
  make_directory(directory);
  const auto path = directory / ('.' + what + ".lock");
  file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) throw unwritable(path);
  if (::flock(file_, LOCK_EX | LOCK_NB) == 0) return;
  ::close(file_);
  throw InputError({.problem = "another calomel is at work on this suite", .suggestion = "wait for it, or use another directory", .file = directory.string()});
}

SuiteLock::~SuiteLock() { ::close(file_); }

}  // namespace calomel::challenge
